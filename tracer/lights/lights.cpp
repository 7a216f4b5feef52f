#include "tracer/lights/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace becalm::tracer {
namespace {

/// Neither kind of light may take all samples: what power says about a scene says little about one point of
/// it.
constexpr double kSmallestShare = 0.1;

/// Weight of the environment beside triangles of this total power.
double environment_weight(double environment_total, double triangle_power, double scene_radius) {
  if (environment_total <= 0.0) return 0.0;
  if (triangle_power <= 0.0) return 1.0;
  if (scene_radius <= 0.0) return triangle_power;
  const double power = std::numbers::pi * scene_radius * scene_radius * environment_total;
  const double share = std::clamp(power / (power + triangle_power), kSmallestShare, 1.0 - kSmallestShare);
  return triangle_power * share / (1.0 - share);
}

/// Scales the sample's density by the probability of its light; nothing when it leaves the range of float.
std::optional<LightSample> chosen(LightSample sample, float probability) {
  sample.pdf_solid_angle *= probability;
  if (sample.pdf_solid_angle == 0.0f) return std::nullopt;
  return sample;
}

}  // namespace

Lights::Lights(std::vector<EmissiveTriangle> triangles, std::optional<Environment> environment,
               float scene_radius)
    : area_lights_(triangles.begin(), triangles.end()), environment_(std::move(environment)) {
  std::vector<double> weights;
  weights.reserve(area_lights_.size() + 1);
  double triangle_power = 0.0;
  for (const AreaLight& light : area_lights_) {
    const double power = light.power();
    weights.push_back(power > 0.0 && std::isfinite(power) ? power : 0.0);
    triangle_power += weights.back();
  }
  if (environment_) {
    weights.push_back(environment_weight(environment_->total(), triangle_power, scene_radius));
  }
  choice_ = DiscreteDistribution(weights);
}

std::optional<LightSample> Lights::sample(const V3f& point, float u_light, const V2f& u) const {
  if (empty()) return std::nullopt;
  const DiscreteDistribution::Choice choice = choice_.sample(u_light);
  if (choice.index < area_lights_.size()) {
    const std::optional<LightSample> sample = area_lights_[choice.index].sample(point, u);
    return sample ? chosen(*sample, choice.probability) : std::nullopt;
  }
  const std::optional<Environment::Sample> sample = environment_->sample(u);
  if (!sample) return std::nullopt;
  return chosen({sample->dir_world, std::numeric_limits<float>::infinity(),
                 environment_->radiance(sample->dir_world), sample->pdf_solid_angle},
                choice.probability);
}

float Lights::pdf_triangle(std::size_t triangle, const V3f&, const V3f& dir_world, float distance) const {
  return area_lights_[triangle].pdf_solid_angle(dir_world, distance) * choice_.probability(triangle);
}

float Lights::pdf_environment(const V3f& dir_world) const {
  if (!environment_) return 0.0f;
  return environment_->pdf_solid_angle(dir_world) * choice_.probability(area_lights_.size());
}

V3f Lights::environment_radiance(const V3f& dir_world) const {
  return environment_ ? environment_->radiance(dir_world) : V3f(0.0f);
}

}  // namespace becalm::tracer
