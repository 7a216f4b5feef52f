#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tracer/lights/environment.h"
#include "tracer/sampling/jitter.h"
#include "tracer/sampling/pixel_filter.h"
#include "tracer/scene/geometry.h"
#include "tracer/scene/light_description.h"
#include "tracer/scene/material.h"
#include "tracer/scene/medium_description.h"
#include "tracer/scene/shutter.h"
#include "tracer/scene/transform.h"

namespace becalm::tracer {

struct FrameRange {
  int first = 1;
  int last = 1;
  double rate = 24.0;  ///< frames per second
};

struct Film {
  int width = 640;
  int height = 360;
  PixelFilter filter;
  Jitter jitter;
};

/// How light that comes straight from an emitter is found; all three have the same expectation.
enum class Direct { mis, light, material };
enum class Heuristic { power, balance };

struct Integrator {
  int max_depth = 8;       ///< scattering events on a path at most; 0 shows emitters alone
  int roulette_depth = 3;  ///< Russian roulette from this many events on
  Direct direct = Direct::mis;
  Heuristic heuristic = Heuristic::power;
};

struct CameraSettings {
  double fov_y_deg = 45.0;
  LookAtCurve look_at = LookAtCurve::Value{0, 0, 5, 0, 0, 0, 0, 1, 0};
  Shutter shutter;
  Curve<1> aperture_radius = Curve<1>::Value{0.0};  ///< scene units; 0: a pinhole
  std::optional<Curve<1>> focus_distance;           ///< along the view, scene units; none: the target's
  std::optional<Curve<1>> eye_separation;           ///< scene units; none: one eye
  std::optional<Curve<1>> convergence_distance;     ///< along the view, scene units; none: the focus distance
  int blades = 0;                                   ///< sides of the aperture; 0: a disc
  double blade_rotation_deg = 0.0;

  bool moves() const {
    const auto changes = [](const std::optional<Curve<1>>& curve) { return curve && curve->animated(); };
    return look_at.animated() || aperture_radius.animated() || changes(focus_distance) ||
           changes(eye_separation) || changes(convergence_distance);
  }
  bool has_two_eyes() const { return eye_separation.has_value(); }
  bool has_lens() const;  ///< whether the aperture is ever open
};

struct Object {
  std::string name;
  std::uint32_t mesh = 0;
  std::uint32_t material = 0;
  std::optional<std::uint32_t> interior;         ///< medium that fills it
  Curve<3> emission = Curve<3>::Value{0, 0, 0};  ///< radiance, uniform over the surface and all directions
  bool emissive = false;                         ///< whether the emission is ever positive
  std::uint16_t light_group = 0;
  bool two_sided = false;  ///< emits from the back as well
  TransformCurve transform = TransformCurve::Value{0, 0, 0, 0, 0, 0, 1, 1, 1};
};

/// All that a scene file says, with its meshes and images loaded.
struct SceneDescription {
  std::string file;  ///< for messages
  FrameRange frames;
  Film film;
  Integrator integrator;
  CameraSettings camera;
  std::optional<Environment> environment;
  bool environment_is_image = false;
  std::uint16_t environment_group = 0;
  std::vector<LightDescription> lights;   ///< beside the environment and the objects that emit
  std::vector<std::string> light_groups;  ///< names, in the order in which the file brings them up
  std::vector<Material> materials;
  std::vector<MediumDescription> media;
  std::vector<Geometry> meshes;
  std::vector<Object> objects;
  Textures textures;
  std::vector<std::string> warnings;  ///< what its files say and is taken otherwise; a line each, not twice
};

}  // namespace becalm::tracer
