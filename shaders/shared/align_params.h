// Push constants of the kernels in shaders/align/, read by C++ and GLSL alike: 4-byte scalars only, so that
// both lay them out the same.
#ifndef BECALM_ALIGN_PARAMS_H
#define BECALM_ALIGN_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

/// align/guide_feature: full resolution in, matching resolution out.
struct GuideFeatureParams {
  int plane;  // first plane read and written
  float weight;
};

/// align/radiance_feature: full resolution in, matching resolution out.
struct RadianceFeatureParams {
  int plane;     // written
  float weight;  // the largest value of the feature
};

/// align/warp_source. Coarse offsets times `coarse_scale` are offsets of this level.
struct WarpSourceParams {
  int level_px;  // full-resolution pixels in one of the level
  float coarse_scale;
};

/// align/match: one level of the search.
struct MatchParams {
  float coarse_scale;
  int refine;  // 1: add the minimum of the quadric through the 3x3 costs around the best
};

/// align/choose_start.
struct ChooseStartParams {
  int planes;
  float coarse_scale;
  int level_px;  // full-resolution pixels in one of this level
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
