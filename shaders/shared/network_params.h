// Push constants of the kernels in shaders/smooth/; see align_params.h for the rules.
#ifndef BECALM_NETWORK_PARAMS_H
#define BECALM_NETWORK_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

/// Sizes of a frame and of its padded copy, which repeats the border up to a size that every scale divides.
struct PaddedParams {
  int width;
  int height;
  int padded_width;
  int padded_height;
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
