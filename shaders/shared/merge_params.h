// Push constants of the kernels in shaders/merge/; see align_params.h for the rules.
#ifndef BECALM_MERGE_PARAMS_H
#define BECALM_MERGE_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

/// merge/mask_gain.
struct MaskGainParams {
  float residual_scale;  // full-resolution pixels in one of the residual's
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
