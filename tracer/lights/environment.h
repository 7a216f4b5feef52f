#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "frame/image.h"
#include "tracer/lights/environment_irradiance.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Radiance that arrives from infinity. Copies share the image, so that every frame's Lights may hold one.
class Environment {
 public:
  struct Sample {
    V3f dir_world;
    float pdf_solid_angle;
  };

  static Environment constant(const V3f& radiance);

  /// Latitude-longitude image: the top row is +y, the centre column -z, columns to its right turn towards +x;
  /// read bilinearly. `rotate_y_deg` turns it counter-clockwise seen from above. 1 channel is grey, of 3 or
  /// more the first three count. NaN and negative values become 0, +Inf becomes 65504 (a half that
  /// overflowed), before scaling. Throws Error(bad_input) for an empty image and for one of 2 channels.
  static Environment image(const Image& rgb, float scale, float rotate_y_deg);

  V3f radiance(const V3f& dir_world) const;

  /// Direction towards the light, with a density that follows the radiance, or, where that is constant, the
  /// cosine of the receiver; nothing when all of it is black.
  std::optional<Sample> sample(const Receiver& at, const V2f& u) const;

  /// What lies in a direction.
  struct Seen {
    V3f radiance;
    V3f dir_world;
    std::optional<float> image_pdf;  ///< none where that of the receiver holds

    /// Of sample().
    float pdf_solid_angle(const Receiver& at) const;
  };
  Seen look(const V3f& dir_world) const;

  /// Radiance integrated over all directions, mean of the channels.
  double total() const { return irradiance_.total(); }

  /// What arrives at the receiver if nothing is in between.
  EnvironmentIrradiance::Arriving arriving(const Receiver& at) const { return irradiance_.at(at); }

  /// Whether it is the same in all directions.
  bool even() const { return map_ == nullptr; }

  /// How many values of the image were NaN, infinite or negative.
  std::size_t replaced_values() const { return replaced_values_; }

 private:
  struct Map;

  // Positions on the image are in texels from the top left.
  V2f image_position(const V3f& dir_world) const;
  V3f radiance_at(const V2f& position) const;
  float pdf_at(const V2f& position) const;
  V3d to_world(const V3d& dir_image) const;
  void measure();

  V3f constant_{0.0f};
  std::shared_ptr<const Map> map_;  ///< null when constant
  float cos_rotation_ = 1.0f;
  float sin_rotation_ = 0.0f;
  EnvironmentIrradiance irradiance_;
  std::size_t replaced_values_ = 0;
};

}  // namespace becalm::tracer
