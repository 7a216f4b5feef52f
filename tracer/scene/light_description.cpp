#include "tracer/scene/light_description.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace becalm::tracer {
namespace {

V3f vector_at(const Curve<3>& curve, double frame) {
  const Curve<3>::Value v = curve.at(frame);
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

float number_at(const Curve<1>& curve, double frame) {
  return static_cast<float>(curve.at(frame)[0]);
}

/// The difference is taken in double: a spot far from the origin is still aimed exactly.
V3f direction_of(const SpotDescription& spot, double frame) {
  Curve<3>::Value direction = spot.aim.at(frame);
  if (spot.aim_is_target) {
    const Curve<3>::Value position = spot.position.at(frame);
    for (std::size_t i = 0; i < 3; ++i) direction[i] -= position[i];
  }
  return V3f(V3d(direction[0], direction[1], direction[2]).normalized());
}

V3f direction_of(const SunDescription& sun, double frame) {
  if (const auto* vector = std::get_if<Curve<3>>(&sun.direction)) {
    const Curve<3>::Value direction = vector->at(frame);
    return V3f(V3d(direction[0], direction[1], direction[2]).normalized());
  }
  const auto& sky = std::get<SkyPosition>(sun.direction);
  const double azimuth = sky.azimuth_deg.at(frame)[0] * std::numbers::pi / 180.0;
  const double elevation = sky.elevation_deg.at(frame)[0] * std::numbers::pi / 180.0;
  return V3f(V3d(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                 -std::cos(azimuth) * std::cos(elevation)));
}

PointLight evaluate(const PointDescription& point, double frame) {
  return {vector_at(point.position, frame), vector_at(point.intensity, frame), point.group, {}};
}

/// Shines nowhere while its target is where it stands.
SpotLight evaluate(const SpotDescription& spot, double frame) {
  // Keys of the two angles at different frames may cross in between.
  const float outer = number_at(spot.outer_deg, frame);
  return {vector_at(spot.position, frame),
          direction_of(spot, frame),
          vector_at(spot.intensity, frame),
          std::min(number_at(spot.inner_deg, frame), outer),
          outer,
          spot.group,
          {}};
}

SunLight evaluate(const SunDescription& sun, double frame) {
  return {direction_of(sun, frame), number_at(sun.diameter_deg, frame), vector_at(sun.irradiance, frame),
          sun.group};
}

bool operator==(const SpotKey& a, const SpotKey& b) {
  return a.position == b.position && a.direction == b.direction;
}

/// Appends the places at the ends of the interval's pieces, unless they are all the same.
template <class Key, class At>
MotionKeys add_keys(const ShutterInterval& shutter, const At& at, std::vector<Key>& keys) {
  const std::size_t first = keys.size();
  for (std::uint32_t i = 0; i <= shutter.segments; ++i) {
    const double share = shutter.segments == 0 ? 0.0 : static_cast<double>(i) / shutter.segments;
    keys.push_back(at(shutter.open + share * (shutter.close - shutter.open)));
  }
  const bool moves = std::any_of(keys.begin() + static_cast<std::ptrdiff_t>(first), keys.end(),
                                 [&](const Key& key) { return !(key == keys[first]); });
  if (moves) return {static_cast<std::uint32_t>(first), shutter.segments};
  keys.resize(first);
  return {};
}

struct Adder {
  const ShutterInterval& shutter;
  LightList& list;
  double middle = 0.5 * (shutter.open + shutter.close);

  void operator()(const PointDescription& point) const {
    PointLight light = evaluate(point, middle);
    light.motion = add_keys(
        shutter, [&](double frame) { return vector_at(point.position, frame); }, list.point_keys);
    list.points.push_back(light);
  }
  void operator()(const SpotDescription& spot) const {
    SpotLight light = evaluate(spot, middle);
    const auto key_at = [&](double frame) {
      return SpotKey{vector_at(spot.position, frame), direction_of(spot, frame)};
    };
    light.motion = add_keys(shutter, key_at, list.spot_keys);
    list.spots.push_back(light);
  }
  void operator()(const SunDescription& sun) const { list.suns.push_back(evaluate(sun, middle)); }
};

struct IsAnimated {
  bool operator()(const PointDescription& point) const {
    return point.position.animated() || point.intensity.animated();
  }
  bool operator()(const SpotDescription& spot) const {
    return spot.position.animated() || spot.aim.animated() || spot.intensity.animated() ||
           spot.inner_deg.animated() || spot.outer_deg.animated();
  }
  bool operator()(const SunDescription& sun) const {
    return std::visit(*this, sun.direction) || sun.diameter_deg.animated() || sun.irradiance.animated();
  }
  bool operator()(const Curve<3>& direction) const { return direction.animated(); }
  bool operator()(const SkyPosition& sky) const {
    return sky.azimuth_deg.animated() || sky.elevation_deg.animated();
  }
};

}  // namespace

bool moves(const LightDescription& light) {
  if (const auto* point = std::get_if<PointDescription>(&light)) return point->position.animated();
  if (const auto* spot = std::get_if<SpotDescription>(&light))
    return spot->position.animated() || spot->aim.animated();
  return false;
}

bool animated(const LightDescription& light) {
  return std::visit(IsAnimated{}, light);
}

void add_lights(std::span<const LightDescription> lights, const ShutterInterval& shutter, LightList& list) {
  for (const LightDescription& light : lights) std::visit(Adder{shutter, list}, light);
}

}  // namespace becalm::tracer
