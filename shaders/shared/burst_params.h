// Push constants of the kernels in shaders/burst/; see align_params.h for the rules.
#ifndef BECALM_BURST_PARAMS_H
#define BECALM_BURST_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

/// burst/reduce.
struct ReduceParams {
  float red_share;  // of the mosaic's samples that are red
  float green_share;
  float blue_share;
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
