#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "frame/image.h"
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
  /// overflowed), before scaling.
  static Environment image(const Image& rgb, float scale, float rotate_y_deg);

  V3f radiance(const V3f& dir_world) const;

  /// Direction towards the light, with a density that follows the radiance; nothing when all of it is black.
  std::optional<Sample> sample(const V2f& u) const;
  float pdf_solid_angle(const V3f& dir_world) const;

  struct Lookup {
    V3f radiance;
    float pdf_solid_angle;
  };
  /// Both at once, for less.
  Lookup look_up(const V3f& dir_world) const;

  /// Radiance integrated over all directions, mean of the channels.
  double total() const { return total_; }

  /// How many values of the image were NaN, infinite or negative.
  std::size_t replaced_values() const { return replaced_values_; }

 private:
  struct Map;

  // Positions on the image are in texels from the top left.
  V2f image_position(const V3f& dir_world) const;
  V3f radiance_at(const V2f& position) const;
  float pdf_at(const V2f& position) const;

  V3f constant_{0.0f};
  std::shared_ptr<const Map> map_;  ///< null when constant
  float cos_rotation_ = 1.0f;
  float sin_rotation_ = 0.0f;
  double total_ = 0.0;
  std::size_t replaced_values_ = 0;
};

}  // namespace becalm::tracer
