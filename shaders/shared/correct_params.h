// Push constants of the kernels in shaders/correct/; see align_params.h for the rules.
#ifndef BECALM_CORRECT_PARAMS_H
#define BECALM_CORRECT_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

struct BlockParams {
  int width;  // of what is written
  int height;
  int width_in;  // of the level below, or above where a coarser level is read
  int height_in;
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
