#include "tracer/lights/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace becalm::tracer {

namespace {

/// Least share of samples of lights within the scene, of suns, and of the environment as far as it is uneven.
constexpr double kLeastShare = 0.05;

constexpr double kLargestBelowOne = 1.0 - 0x1p-53;

/// Scales the sample's density by the probability of its light; nothing when it leaves the range of float.
std::optional<LightSample> chosen(std::optional<LightSample> sample, float probability) {
  if (!sample) return std::nullopt;
  sample->pdf_solid_angle *= probability;
  if (!(sample->pdf_solid_angle > 0.0f)) return std::nullopt;
  return sample;
}

}  // namespace

Lights::Lights(LightList list)
    : environment_(std::move(list.environment)), environment_group_(list.environment_group) {
  for (const SunLight& sun : list.suns) {
    if (const SunEmitter emitter(sun); emitter.shines()) suns_.push_back(emitter);
  }
  if (environment_ && !(environment_->total() > 0.0)) environment_.reset();
  emitters_ = Emitters(list);
  for (std::size_t i = 0; i < emitters_.count(); ++i) {
    if (emitters_.radiant_intensity(i) > 0.0) finite_.push_back(static_cast<std::uint32_t>(i));
  }
  if (finite_.size() <= kLargestSet) return;
  std::vector<LightBounds> bounds(emitters_.count());
  for (const std::uint32_t i : finite_) bounds[i] = emitters_.bounds(i);
  tree_ = LightTree(bounds);
  finite_.clear();
}

Lights::Received Lights::received(const Receiver& at, float time) const {
  Received received;
  received.at_ = at;
  received.time_ = time;
  // An even environment shares nothing with other lights: whether any shines suffices.
  const bool shares = !suns_.empty() || (environment_ && !environment_->even());
  double& all_finite = received.all_finite_;
  if (!tree_.empty() && shares) {
    all_finite = tree_.irradiance_at(at);
  } else if (!tree_.empty()) {
    all_finite = !environment_ || tree_.reaches(at) ? 1.0 : 0.0;
  } else if (finite_.size() == 1 && !shares) {
    all_finite = !environment_ || emitters_.reaches(finite_[0], at, time) ? 1.0 : 0.0;
    received.each_finite_[0] = all_finite;
  } else {
    for (std::size_t i = 0; i < finite_.size(); ++i) {
      received.each_finite_[i] = emitters_.irradiance_at(finite_[i], at, time);
      all_finite += received.each_finite_[i];
    }
  }
  for (const SunEmitter& sun : suns_) received.all_suns_ += sun.irradiance_at(at);
  if (environment_ && all_finite == 0.0 && received.all_suns_ == 0.0) {
    received.environment_ = 1.0f;
    return received;
  }
  EnvironmentIrradiance::Arriving sky{0.0, 0.0};
  if (environment_ && !environment_->even()) sky = environment_->arriving(at);
  const double uneven = sky.irradiance * sky.unevenness;
  const double all = all_finite + received.all_suns_ + uneven;
  if (!(all > 0.0)) return received;
  const double least_finite = all_finite > 0.0 ? kLeastShare : 0.0;
  const double least_suns = received.all_suns_ > 0.0 ? kLeastShare : 0.0;
  const double least_environment = kLeastShare * sky.unevenness;
  const double rest = (1.0 - least_finite - least_suns - least_environment) / all;
  received.finite_ = static_cast<float>(least_finite + rest * all_finite);
  received.suns_ = static_cast<float>(least_suns + rest * received.all_suns_);
  received.environment_ = static_cast<float>(least_environment + rest * uneven);
  return received;
}

float Lights::probability(std::size_t emitter, const Received& received) const {
  if (!tree_.empty()) return received.finite_ * tree_.probability(emitter, received.at_);
  const auto found = std::ranges::find(finite_, emitter);
  if (found == finite_.end()) return 0.0f;
  return Received::part(received.finite_, received.each_finite_[found - finite_.begin()],
                        received.all_finite_);
}

std::optional<LightSample> Lights::sample(const Received& received, float u_light, const V2f& u) const {
  const double finite = received.finite_, suns = received.suns_;
  // Rounded probabilities may leave a gap below 1.
  const double target = std::min<double>(u_light, kLargestBelowOne) * (finite + suns + received.environment_);
  if (target < finite) return sample_finite(received, target / finite, u);
  if (target < finite + suns) return sample_suns(received, (target - finite) / suns, u);
  if (received.environment_ == 0.0f) return std::nullopt;
  return chosen(sample_environment(received, u), received.environment_);
}

/// `u_kind` in [0,1] chooses among the kind.
std::optional<LightSample> Lights::sample_finite(const Received& received, double u_kind,
                                                 const V2f& u) const {
  const auto sample = [&](std::size_t emitter, float probability) {
    return chosen(emitters_.sample(emitter, received.at_, received.time_, u), probability);
  };
  if (!tree_.empty()) {
    const std::optional<LightTree::Choice> choice = tree_.sample(received.at_, static_cast<float>(u_kind));
    return choice ? sample(choice->index, received.finite_ * choice->probability) : std::nullopt;
  }
  double target = u_kind * received.all_finite_;
  std::size_t last = 0;
  for (std::size_t i = 0; i < finite_.size(); ++i) {
    const double weight = received.each_finite_[i];
    if (weight == 0.0) continue;
    last = i;
    if (target < weight) break;
    target -= weight;
  }
  return sample(finite_[last],
                Received::part(received.finite_, received.each_finite_[last], received.all_finite_));
}

std::optional<LightSample> Lights::sample_suns(const Received& received, double u_kind, const V2f& u) const {
  double target = u_kind * received.all_suns_;
  const SunEmitter* last = nullptr;
  double last_weight = 0.0;
  for (const SunEmitter& sun : suns_) {
    const double weight = sun.irradiance_at(received.at_);
    if (weight == 0.0) continue;
    last = &sun;
    last_weight = weight;
    if (target < weight) break;
    target -= weight;
  }
  if (last == nullptr) return std::nullopt;
  return chosen(last->sample(u), Received::part(received.suns_, last_weight, received.all_suns_));
}

std::optional<LightSample> Lights::sample_environment(const Received& received, const V2f& u) const {
  const std::optional<Environment::Sample> sample = environment_->sample(received.at_, u);
  if (!sample) return std::nullopt;
  return LightSample{sample->dir_world,
                     std::numeric_limits<float>::infinity(),
                     environment_->radiance(sample->dir_world),
                     sample->pdf_solid_angle,
                     environment_group_,
                     false};
}

float Lights::pdf_triangle(std::size_t triangle, const Received& received, const V3f& dir_world,
                           float distance) const {
  const std::size_t area = emitters_.of_triangle(triangle);
  const float chosen = probability(area, received);
  if (chosen == 0.0f) return 0.0f;
  return chosen * emitters_.pdf_area(area, received.at_, dir_world, distance, received.time_);
}

float Lights::pdf_sphere(std::size_t sphere, const Received& received) const {
  return probability(emitters_.of_sphere(sphere), received) *
         emitters_.pdf_sphere(sphere, received.at_, received.time_);
}

}  // namespace becalm::tracer
