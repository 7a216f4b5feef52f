// Push constants of the kernels in shaders/smooth/; see align_params.h for the rules.
#ifndef BECALM_SMOOTH_PARAMS_H
#define BECALM_SMOOTH_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

struct SmoothParams {
  int width;
  int height;
  float strength;  // noise that patches may differ by, in standard deviations (k of non-local means)
  float surfaces;  // how much differences of normal, albedo and depth count against a pixel of the window
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
