// Push constants of the kernels in shaders/merge/; see align_params.h for the rules.
#ifndef BECALM_MERGE_PARAMS_H
#define BECALM_MERGE_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

struct WarpHistoryParams {
  int width;
  int height;
  int history_width;
  int history_height;
};

struct MaskGainParams {
  int width;
  int height;
  int residual_width;  // the level whose patch distance rejects
  int residual_height;
  float residual_scale;  // full-resolution pixels in one of the residual's
  float alpha;
  float kappa;
  float eta;
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
