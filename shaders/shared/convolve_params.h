// Push constants and sizes of the kernels in shaders/smooth/convolve*.comp; see align_params.h for the rules.
#ifndef BECALM_CONVOLVE_PARAMS_H
#define BECALM_CONVOLVE_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

const int kPlanesMade = 2;      // of the result, per workgroup
const int kBlock = 2;           // pixels of the result that an invocation makes, along an axis
const int kDirectTaps = 9;      // of a pixel
const int kUpsampledTaps = 16;  // of the four pixels of the result in one of a source of half the size

struct ConvolveParams {
  int first_plane;   // of the source that the pass reads
  int first_weight;  // of the pass, counted in vec4
  int rectify;       // 1: sums below zero become zero
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
