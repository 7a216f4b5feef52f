// Push constants of the kernels in shaders/align/, read by C++ and GLSL alike: 4-byte scalars only, so that
// both lay them out the same. Sizes are in pixels of the image that the kernel writes unless a name says
// otherwise.
#ifndef BECALM_ALIGN_PARAMS_H
#define BECALM_ALIGN_PARAMS_H

#ifdef __cplusplus
namespace becalm::filter::params {
#endif

/// align/guide_feature: full resolution in, matching resolution out.
struct GuideFeatureParams {
  int width_in;
  int height_in;
  int width;
  int height;
  int plane_in;  // first plane read
  int plane;     // first plane written
  int planes;
  float weight;
};

/// align/radiance_feature: full resolution in, matching resolution out.
struct RadianceFeatureParams {
  int width_in;
  int height_in;
  int width;
  int height;
  int downsample;  // 1, 2 or 4
  int plane;       // written
  float weight;    // 0 if prefilter steps follow
};

/// align/prefilter.
struct PrefilterParams {
  int width;
  int height;
  int step;      // distance of the taps
  int plane;     // written
  float weight;  // as in RadianceFeatureParams
};

/// align/downsample: one pyramid level to the next.
struct DownsampleParams {
  int width_in;
  int height_in;
  int width;
  int height;
};

/// align/warp_source. Coarse offsets times `coarse_scale` are offsets of this level.
struct WarpSourceParams {
  int width;
  int height;
  int source_width;
  int source_height;
  int level_px;  // full-resolution pixels in one of the level
  int coarse_width;
  int coarse_height;
  float coarse_scale;
};

/// align/match: one level of the search.
struct MatchParams {
  int width;
  int height;
  int coarse_width;
  int coarse_height;
  float coarse_scale;
  int refine;  // 1: add the minimum of the quadric through the 3x3 costs around the best
};

/// align/choose_start: sizes of the level in target and source, of the coarser offsets, and of the motion.
struct ChooseStartParams {
  int width;
  int height;
  int source_width;
  int source_height;
  int planes;
  int coarse_width;
  int coarse_height;
  float coarse_scale;
  int full_width;
  int full_height;
  int level_px;  // full-resolution pixels in one of this level
};

/// align/upsample_offset: matching resolution to full resolution.
struct UpsampleParams {
  int width_in;
  int height_in;
  int width;
  int height;
};

#ifdef __cplusplus
}  // namespace becalm::filter::params
#endif
#endif
