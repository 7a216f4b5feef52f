// Push constants of the kernels in shaders/antialias/; see align_params.h for the rules.
#ifndef BECALM_ANTIALIAS_PARAMS_H
#define BECALM_ANTIALIAS_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

/// Side in pixels of the tiles whose light antialias/tile_light sums.
const int kTile = 8;

/// antialias/accumulate. `edge_*` is how far the first pixel's edge lies beyond that of the residual's, in
/// pixels.
struct AccumulateParams {
  float residual_scale;  // pixels in one of the residual's
  float edge_x;
  float edge_y;
};

/// antialias/scale_offset. `edge_*` is how far the first pixel's edge lies beyond that of the first sample's,
/// in pixels.
struct ScaleOffsetParams {
  float scale;  // pixels in one sample's
  float edge_x;
  float edge_y;
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
