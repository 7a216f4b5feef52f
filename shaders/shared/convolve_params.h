// Push constants of the kernels in shaders/smooth/convolve*.comp; see align_params.h for the rules.
#ifndef BECALM_CONVOLVE_PARAMS_H
#define BECALM_CONVOLVE_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

struct ConvolveParams {
  int first_plane;   // of the source that the pass reads
  int first_weight;  // of the pass, counted in vec4
  int rectify;       // 1: sums below zero become zero
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
