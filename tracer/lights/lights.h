#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tracer/lights/emitters.h"
#include "tracer/lights/environment.h"
#include "tracer/lights/light_list.h"
#include "tracer/lights/light_tree.h"
#include "tracer/lights/sun_light.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// All emitters of a frame. One is chosen by what each sends to the receiver if nothing is in between: few
/// within the scene by an estimate each, many by a tree (see LightTree). Emitters without size, without power
/// or with values that are not finite are never chosen. As it is not known what is in between, lights within
/// the scene, suns and an uneven environment each take a least share of the samples where they can shine; an
/// even environment is left to the material's samples where anything else can. `time` is the position in the
/// shutter interval, in [0,1].
class Lights {
 public:
  Lights() = default;
  explicit Lights(LightList list);

  /// Whether there is nothing to sample.
  bool empty() const { return finite_.empty() && tree_.empty() && suns_.empty() && !environment_; }

  /// What the lights send to a receiver if nothing is in between, and what they are chosen by.
  class Received;

  Received received(const Receiver& at, float time) const;

  /// Direction from the receiver to a light. Nothing when the chosen light cannot shine on it (behind a
  /// one-sided triangle, edge-on, outside a spot's cone): this is part of the estimate, do not draw again.
  std::optional<LightSample> sample(const Received& received, float u_light, const V2f& u) const;

  /// Density per solid angle with which sample() finds triangle number `triangle` (of the list) in this
  /// direction at this distance; 0 where sample() gives nothing.
  float pdf_triangle(std::size_t triangle, const Received& received, const V3f& dir_world,
                     float distance) const;

  /// The same for sphere number `sphere`, in any direction in which it is seen from the receiver.
  float pdf_sphere(std::size_t sphere, const Received& received) const;

  /// Calls f(radiance, group, pdf) for each light from infinity that a ray in the unit direction runs into:
  /// the environment, and suns whose disc contains it. pdf(received) is the density per solid angle with
  /// which sample() finds the direction.
  template <class F>
  void for_each_infinite(const V3f& dir_world, const F& f) const;

 private:
  /// More emitters within the scene than this are chosen by a tree.
  static constexpr std::size_t kLargestSet = 11;

  float probability(std::size_t emitter, const Received& received) const;
  std::optional<LightSample> sample_finite(const Received& received, double u_kind, const V2f& u) const;
  std::optional<LightSample> sample_suns(const Received& received, double u_kind, const V2f& u) const;
  std::optional<LightSample> sample_environment(const Received& received, const V2f& u) const;

  Emitters emitters_;
  std::vector<std::uint32_t>
      finite_;  ///< those of the emitters that can be sampled; none if they are in the tree
  LightTree tree_;
  std::vector<SunEmitter> suns_;
  std::optional<Environment> environment_;
  std::uint16_t environment_group_ = 0;
};

class Lights::Received {
 private:
  friend class Lights;

  /// Probability of one that has this part of the weight of its kind.
  static float part(float kind, double weight, double all) {
    return weight > 0.0 ? static_cast<float>(kind * (weight / all)) : 0.0f;
  }

  Receiver at_{V3f(0.0f)};
  float time_ = 0.0f;
  // Probabilities of the kinds.
  float finite_ = 0.0f;
  float suns_ = 0.0f;
  float environment_ = 0.0f;
  // Weights within them.
  std::array<double, kLargestSet> each_finite_;  ///< of Lights::finite_
  double all_finite_ = 0.0;
  double all_suns_ = 0.0;
};

template <class F>
void Lights::for_each_infinite(const V3f& dir_world, const F& f) const {
  if (environment_) {
    const Environment::Seen seen = environment_->look(dir_world);
    f(seen.radiance, environment_group_,
      [&](const Received& received) { return seen.pdf_solid_angle(received.at_) * received.environment_; });
  }
  for (const SunEmitter& sun : suns_) {
    if (!sun.contains(dir_world)) continue;
    f(sun.radiance, sun.group, [&](const Received& received) {
      return sun.pdf_solid_angle() *
             Received::part(received.suns_, sun.irradiance_at(received.at_), received.all_suns_);
    });
  }
}

}  // namespace becalm::tracer
