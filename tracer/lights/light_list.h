#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tracer/lights/area_light.h"
#include "tracer/lights/environment.h"
#include "tracer/lights/point_light.h"
#include "tracer/lights/sphere_light.h"
#include "tracer/lights/spot_light.h"
#include "tracer/lights/sun_light.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// What shines in a frame. Emitters that move during the shutter interval refer to the arrays of keys.
struct LightList {
  std::vector<EmissiveTriangle> triangles;
  std::vector<EmissiveSphere> spheres;
  std::vector<PointLight> points;
  std::vector<SpotLight> spots;
  std::vector<SunLight> suns;
  std::optional<Environment> environment;
  std::uint16_t environment_group = 0;

  std::vector<TriangleKey> triangle_keys;
  std::vector<SphereKey> sphere_keys;
  std::vector<V3f> point_keys;
  std::vector<SpotKey> spot_keys;
};

}  // namespace becalm::tracer
