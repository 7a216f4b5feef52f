#include "tracer/lights/lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace becalm::tracer {
namespace {

/// No kind of light may be starved of samples: what power says about a scene says little about one point of
/// it.
constexpr double kSmallestShare = 0.1;

/// From so many lights within the scene on they are chosen by a tree.
constexpr std::ptrdiff_t kSmallestTree = 16;

/// Lights within the scene, suns, the environment.
using Kinds = std::array<double, 3>;

/// Parts of 1 in proportion to power, but none that has power below kSmallestShare.
Kinds shares_of(const Kinds& power) {
  Kinds share{};
  std::array<bool, 3> raised{};
  // Raising one to the least lowers the others, of which one may then have to be raised as well.
  for (std::size_t round = 0; round < power.size(); ++round) {
    double free_power = 0.0, free_share = 1.0;
    for (std::size_t k = 0; k < power.size(); ++k) {
      if (raised[k]) {
        free_share -= kSmallestShare;
      } else {
        free_power += power[k];
      }
    }
    for (std::size_t k = 0; k < power.size(); ++k) {
      if (raised[k] || power[k] == 0.0) continue;
      share[k] = free_share * (power[k] / free_power);
    }
    for (std::size_t k = 0; k < power.size(); ++k) {
      if (power[k] == 0.0 || share[k] >= kSmallestShare) continue;
      share[k] = kSmallestShare;
      raised[k] = true;
    }
  }
  return share;
}

double usable(double power) {
  return power > 0.0 && std::isfinite(power) ? power : 0.0;
}

/// Scales the sample's density by the probability of its light; nothing when it leaves the range of float.
std::optional<LightSample> chosen(std::optional<LightSample> sample, float probability) {
  if (!sample) return std::nullopt;
  sample->pdf_solid_angle *= probability;
  if (sample->pdf_solid_angle == 0.0f) return std::nullopt;
  return sample;
}

bool any_moving(const std::vector<EmissiveTriangle>& triangles) {
  return std::any_of(triangles.begin(), triangles.end(),
                     [](const EmissiveTriangle& triangle) { return triangle.motion.moving(); });
}

}  // namespace

Lights::Lights(LightList list)
    : triangles_(list.triangles.begin(), list.triangles.end()),
      spheres_(std::move(list.spheres)),
      points_(std::move(list.points)),
      spots_(list.spots.begin(), list.spots.end()),
      suns_(list.suns.begin(), list.suns.end()),
      environment_(std::move(list.environment)),
      environment_group_(list.environment_group),
      triangle_keys_(std::move(list.triangle_keys)),
      sphere_keys_(std::move(list.sphere_keys)),
      point_keys_(std::move(list.point_keys)),
      spot_keys_(std::move(list.spot_keys)) {
  if (any_moving(list.triangles)) {
    for (const EmissiveTriangle& triangle : list.triangles) triangle_motion_.push_back(triangle.motion);
  }
  std::vector<double> weights = finite_powers();
  for (const SunEmitter& sun : suns_) weights.push_back(usable(sun.total()));
  if (environment_) weights.push_back(usable(environment_->total()));

  const auto suns = weights.begin() + static_cast<std::ptrdiff_t>(first_sun());
  const auto environment = suns + static_cast<std::ptrdiff_t>(suns_.size());
  const double disc = std::numbers::pi * list.scene_radius * list.scene_radius;
  const Kinds sums = {std::accumulate(weights.begin(), suns, 0.0), std::accumulate(suns, environment, 0.0),
                      std::accumulate(environment, weights.end(), 0.0)};
  Kinds power = {sums[0], sums[1] * disc, sums[2] * disc};
  if (!(disc > 0.0)) {
    std::transform(sums.begin(), sums.end(), power.begin(), [](double sum) { return sum > 0.0 ? 1.0 : 0.0; });
  }
  const Kinds share = shares_of(power);
  const auto give = [](auto begin, auto end, double sum, double share_of_kind) {
    std::transform(begin, end, begin, [&](double weight) { return weight / sum * share_of_kind; });
  };
  if (sums[0] > 0.0) give(weights.begin(), suns, sums[0], share[0]);
  if (sums[1] > 0.0) give(suns, environment, sums[1], share[1]);
  if (sums[2] > 0.0) give(environment, weights.end(), sums[2], share[2]);
  first_infinite_ = first_sun();
  if (std::count_if(weights.begin(), suns, [](double w) { return w > 0.0; }) >= kSmallestTree) {
    tree_ = LightTree(finite_bounds({weights.data(), first_sun()}));
    weights.erase(weights.begin() + 1, suns);
    weights.front() = share[0];
    first_infinite_ = 1;
  }
  choice_ = DiscreteDistribution(weights);
}

std::vector<double> Lights::finite_powers() const {
  std::vector<double> powers;
  powers.reserve(first_sun());
  const auto add = [&](const MotionKeys& motion, const auto& power_at) {
    powers.push_back(usable(motion.moving() ? mean_over_shutter(motion, power_at) : power_at(0.0f)));
  };
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    add(moving(i) ? triangle_motion_[i] : MotionKeys{},
        [&](float time) { return (moving(i) ? triangle_at(i, time) : triangles_[i]).power(); });
  }
  // The power does not tell whether the position is finite.
  const auto if_finite = [](double power, const V3f& place) { return is_finite(place) ? power : 0.0; };
  for (const EmissiveSphere& sphere : spheres_) {
    add(sphere.motion, [&](float time) {
      const EmissiveSphere now = sphere_at(sphere, time);
      return if_finite(now.power(), now.center);
    });
  }
  for (const PointLight& point : points_) {
    add(point.motion, [&](float time) { return if_finite(point.power(), point_at(point, time).position); });
  }
  for (const SpotEmitter& spot : spots_) {
    add(spot.motion, [&](float time) {
      const SpotEmitter now = spot_at(spot, time);
      return if_finite(now.power(), now.position);
    });
  }
  return powers;
}

/// The bounds of moving emitters face everywhere.
std::vector<LightBounds> Lights::finite_bounds(std::span<const double> powers) const {
  std::vector<LightBounds> all(powers.size());
  // Linear motion stays in the box of its keys.
  const auto extend = [](LightBounds& bounds, const MotionKeys& motion, const auto& extend_at) {
    for (std::uint32_t i = 0; i <= motion.segments; ++i) {
      extend_at(bounds.box,
                motion.moving() ? static_cast<float>(i) / static_cast<float>(motion.segments) : 0.0f);
    }
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    LightBounds& bounds = all[i];
    bounds.power = powers[i];
    if (powers[i] == 0.0) continue;
    if (i < first_sphere()) {
      bounds.two_sided = triangles_[i].two_sided;
      if (!moving(i)) bounds.facing = {V3d(triangles_[i].normal), 0.0};
      extend(bounds, moving(i) ? triangle_motion_[i] : MotionKeys{}, [&](Imath::Box3d& box, float time) {
        const AreaLight light = moving(i) ? triangle_at(i, time) : triangles_[i];
        box.extendBy(V3d(light.p0));
        box.extendBy(V3d(light.p0) + V3d(light.edge1));
        box.extendBy(V3d(light.p0) + V3d(light.edge2));
      });
    } else if (i < first_point()) {
      const EmissiveSphere& sphere = spheres_[i - first_sphere()];
      extend(bounds, sphere.motion, [&](Imath::Box3d& box, float time) {
        const EmissiveSphere now = sphere_at(sphere, time);
        box.extendBy(V3d(now.center) - V3d(now.radius));
        box.extendBy(V3d(now.center) + V3d(now.radius));
      });
    } else if (i < first_spot()) {
      const PointLight& point = points_[i - first_point()];
      extend(bounds, point.motion,
             [&](Imath::Box3d& box, float time) { box.extendBy(V3d(point_at(point, time).position)); });
    } else {
      const SpotEmitter& spot = spots_[i - first_spot()];
      if (!spot.motion.moving()) bounds.facing = {spot.axis, 0.0};
      bounds.emission_rad = std::acos(1.0 - spot.outer);
      extend(bounds, spot.motion,
             [&](Imath::Box3d& box, float time) { box.extendBy(V3d(spot_at(spot, time).position)); });
    }
  }
  return all;
}

AreaLight Lights::triangle_at(std::size_t triangle, float time) const {
  const AreaLight& light = triangles_[triangle];
  const TriangleKey corners =
      key_at<TriangleKey>(triangle_keys_, triangle_motion_[triangle], time,
                          [](const TriangleKey& a, const TriangleKey& b, float t) -> TriangleKey {
                            return {interpolate_linear(a[0], b[0], t), interpolate_linear(a[1], b[1], t),
                                    interpolate_linear(a[2], b[2], t)};
                          });
  return AreaLight({corners[0], corners[1], corners[2], light.radiance, light.two_sided, light.group, {}});
}

EmissiveSphere Lights::sphere_at(const EmissiveSphere& sphere, float time) const {
  if (!sphere.motion.moving()) return sphere;
  const SphereKey key = key_at<SphereKey>(
      sphere_keys_, sphere.motion, time, [](const SphereKey& a, const SphereKey& b, float t) -> SphereKey {
        return {interpolate_linear(a.center, b.center, t), a.radius * (1.0f - t) + b.radius * t};
      });
  return {key.center, key.radius, sphere.radiance, sphere.two_sided, sphere.group, {}};
}

PointLight Lights::point_at(const PointLight& point, float time) const {
  if (!point.motion.moving()) return point;
  return {key_at<V3f>(point_keys_, point.motion, time, interpolate_linear), point.intensity, point.group, {}};
}

SpotEmitter Lights::spot_at(const SpotEmitter& spot, float time) const {
  if (!spot.motion.moving()) return spot;
  const SpotKey key = key_at<
      SpotKey>(spot_keys_, spot.motion, time, [](const SpotKey& a, const SpotKey& b, float t) -> SpotKey {
    return {interpolate_linear(a.position, b.position, t), interpolate_linear(a.direction, b.direction, t)};
  });
  SpotEmitter now = spot;
  now.position = key.position;
  now.axis = V3d(key.direction).normalized();
  return now;
}

std::optional<LightSample> Lights::sample_emitter(std::size_t number, const V3f& point, float time,
                                                  const V2f& u) const {
  if (number < first_sphere()) {
    return (moving(number) ? triangle_at(number, time) : triangles_[number]).sample(point, u);
  }
  if (number < first_point()) return sphere_at(spheres_[number - first_sphere()], time).sample(point, u);
  if (number < first_spot()) return point_at(points_[number - first_point()], time).sample(point);
  if (number < first_sun()) return spot_at(spots_[number - first_spot()], time).sample(point);
  if (number < first_sun() + suns_.size()) return suns_[number - first_sun()].sample(u);
  const std::optional<Environment::Sample> sample = environment_->sample(u);
  if (!sample) return std::nullopt;
  return LightSample{sample->dir_world,
                     std::numeric_limits<float>::infinity(),
                     environment_->radiance(sample->dir_world),
                     sample->pdf_solid_angle,
                     environment_group_,
                     false};
}

std::optional<LightSample> Lights::sample(const V3f& point, float time, float u_light, const V2f& u) const {
  if (empty()) return std::nullopt;
  const DiscreteDistribution::Choice choice = choice_.sample(u_light);
  if (!tree_.empty() && choice.index == 0) {
    const std::optional<LightTree::Choice> emitter = tree_.sample(point, choice.u);
    if (!emitter) return std::nullopt;
    return chosen(sample_emitter(emitter->index, point, time, u), choice.probability * emitter->probability);
  }
  return chosen(sample_emitter(choice.index - first_infinite_ + first_sun(), point, time, u),
                choice.probability);
}

float Lights::pdf_triangle(std::size_t triangle, const V3f& point, const V3f& dir_world, float distance,
                           float time) const {
  const float pdf = moving(triangle) ? triangle_at(triangle, time).pdf_solid_angle(dir_world, distance)
                                     : triangles_[triangle].pdf_solid_angle(dir_world, distance);
  return pdf * probability(triangle, point);
}

float Lights::pdf_sphere(std::size_t sphere, const V3f& point, float time) const {
  return sphere_at(spheres_[sphere], time).pdf_solid_angle(point) *
         probability(first_sphere() + sphere, point);
}

}  // namespace becalm::tracer
