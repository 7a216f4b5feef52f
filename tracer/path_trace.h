#pragma once

#include <span>
#include <vector>

#include "tracer/camera_animation.h"
#include "tracer/radiance_split.h"
#include "tracer/sampling/sampler.h"
#include "tracer/scene/scene_needs.h"
#include "tracer/snapshot/interiors.h"
#include "tracer/snapshot/snapshot.h"

namespace becalm::tracer {

/// Numbers of the object and the material that a path met first; 0 where there was none.
struct SurfaceIds {
  std::uint32_t object = 0;
  std::uint32_t material = 0;
};

/// What a path says about the surfaces it met, for the AOVs of the same names.
struct Guides {
  V3f albedo{1.0f};
  V3f normal{0.0f};
  float depth = std::numeric_limits<float>::infinity();
  V2f motion{0.0f};  ///< offset_cur_to_prev_px
  SurfaceIds ids;
};

struct PathSample {
  V3f radiance{0.0f};
  /// Whether the primary ray met a surface, was scattered or absorbed, or there is an environment behind.
  bool covered = false;
  Guides guides;  ///< only if asked for
};

/// One scattering event, for whoever replays a path.
struct PathVertex {
  std::uint32_t object;
  V3f position;
  V3f throughput;  ///< on arrival
  V3f radiance;    ///< of the path so far, the light found here included
};

/// A ray query as it was made, for benchmarks that replay a frame's rays.
struct RecordedRay {
  Ray ray;
  bool occlusion;  ///< whether any hit sufficed
};

/// What all paths of a tile share.
struct PathContext {
  const Snapshot& snapshot;
  const Integrator& integrator;
  const CameraAnimation& cameras;
  const Interiors& eye_interiors;  ///< what the camera stands in
  Textures::Reader textures;
  float footprint_scale = 1.0f;              ///< see scene/texture.h
  bool mixes = false;                        ///< whether materials are mixed: one more random number an event
  bool guides_only = false;                  ///< paths end where their guides are known, and find no light
  RadianceSplit* split = nullptr;            ///< the path's radiance is added to it if not null
  std::vector<PathVertex>* log = nullptr;    ///< filled if not null
  std::vector<RecordedRay>* rays = nullptr;  ///< filled if not null
};

/// Estimates the radiance that arrives at that raster position.
using PathFunction = PathSample (*)(const PathContext& context, const V2f& raster, Sampler& sampler);

/// The integrator compiled with some of its features.
struct PathVariant {
  const char* name;
  bool surfaces;  ///< materials other than plain diffuse ones
  bool textures;  ///< what varies over a surface, and the ray differentials that say how far to average it
  bool media;     ///< scattering inside objects, and interfaces that only bound them
  bool blur;      ///< the shutter is open for a time, or the lens has a width
  PathFunction function;
};

/// All of them, each doing more than those before; a variant that does too much gives the same radiance up to
/// noise.
std::span<const PathVariant> path_variants(bool with_guides);

/// The first that does all that the scene needs, with guides if asked for.
const PathVariant& select_path_variant(const SceneNeeds& needs, bool with_guides);

}  // namespace becalm::tracer
