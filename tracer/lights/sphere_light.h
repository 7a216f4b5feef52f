#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "tracer/lights/cone.h"
#include "tracer/lights/irradiance.h"
#include "tracer/lights/light_sample.h"
#include "tracer/lights/motion_keys.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A place of a moving sphere.
struct SphereKey {
  V3f center;
  float radius;
};

/// Emits `radiance` outward, or inward as well. Sampled uniformly over the directions in which it is seen:
/// the cone that it subtends, or all around from inside. Works in double from the float positions on, so that
/// spheres from far below to far above their distance in size are sampled to the precision of a direction.
/// Not sampled from its own surface, where rounding decides on which side of it a position lies: what the
/// surface sends to itself is left to the directions that the material draws.
struct EmissiveSphere {
  V3f center;
  float radius;
  V3f radiance;
  bool two_sided = false;
  std::uint16_t group = 0;
  MotionKeys motion = {};  ///< among LightList::sphere_keys

  /// Radiant intensity in any direction, mean of the channels; 0 without a radius.
  double radiant_intensity() const {
    return radius > 0.0f ? std::numbers::pi * static_cast<double>(radius) * radius * channel_mean(radiance)
                         : 0.0;
  }

  /// What arrives at the receiver if nothing is in between, as irradiance.h has it; 0 where sample() gives
  /// nothing.
  double irradiance_at(const Receiver& at) const {
    const Seen seen(*this, at.position);
    if (!seen.visible) return 0.0;
    const double mean = channel_mean(radiance);
    if (!at.faces()) return mean * seen.cone.solid_angle();
    return mean * (seen.inside
                       ? std::numbers::pi
                       : sphere_irradiance(radius / seen.distance, V3d(at.normal).dot(seen.cone.axis)));
  }

  /// Whether that is not 0.
  bool reaches(const Receiver& at) const {
    const V3d to_center = V3d(center) - V3d(at.position);
    const double r = radius, squared = to_center.length2();
    if (!(r > 0.0 && std::isfinite(squared)) || holds(std::sqrt(squared))) return false;
    if (squared <= r * r) return two_sided;
    return !at.faces() || V3d(at.normal).dot(to_center) > -r;
  }

  /// Density per solid angle of any direction in which the sphere is seen from the receiver. 0 where sample()
  /// gives nothing: inside if one-sided, on the surface, and when the sphere subtends so little that the
  /// density leaves the range of float (a radius below 1e-19 of the distance).
  float pdf_solid_angle(const Receiver& at) const {
    const Seen seen(*this, at.position);
    return seen.visible ? density(seen) : 0.0f;
  }

  std::optional<LightSample> sample(const Receiver& at, const V2f& u) const {
    const Seen seen(*this, at.position);
    const float pdf = seen.visible ? density(seen) : 0.0f;
    if (pdf == 0.0f) return std::nullopt;
    const Cone::Direction drawn = seen.cone.sample(u);
    // The ray meets the sphere at the roots of t^2 - 2 t along + beyond: outside the nearer one counts,
    // inside the only positive one, each written so that nothing cancels.
    const double r = radius;
    const double along = seen.distance * drawn.cosine;
    const double beyond = (seen.distance - r) * (seen.distance + r);
    const double half_chord =
        std::sqrt(std::max(0.0, r * r - seen.distance * seen.distance * drawn.sine_squared));
    const double distance = seen.inside && along > 0.0 ? along + half_chord
                            : seen.inside              ? beyond / (along - half_chord)
                                                       : beyond / (along + half_chord);
    if (!(distance > 0.0)) return std::nullopt;
    return LightSample{V3f(drawn.dir), static_cast<float>(distance), radiance, pdf, group, false, extent()};
  }

 private:
  float extent() const { return largest_coordinate(center) + radius; }

  /// Whether a position so far from the centre lies on the surface, to the rounding of positions there.
  bool holds(double distance) const {
    constexpr double rounding = 0x1p-18;
    return std::abs(distance - radius) <= rounding * extent();
  }

  /// The sphere as a point sees it.
  struct Seen {
    double distance;  ///< of the centre
    bool inside;
    bool visible;
    Cone cone;

    Seen(const EmissiveSphere& sphere, const V3f& point) {
      const V3d to_center = V3d(sphere.center) - V3d(point);
      const double r = sphere.radius;
      distance = to_center.length();
      inside = distance <= r;
      visible =
          r > 0.0 && std::isfinite(distance) && (!inside || sphere.two_sided) && !sphere.holds(distance);
      if (inside) {
        cone = {distance > 0.0 ? to_center / distance : V3d(0.0, 0.0, 1.0), 2.0};
        return;
      }
      const double sine = r / distance;
      const double cosine = std::sqrt((distance - r) / distance * ((distance + r) / distance));
      cone = {to_center / distance, sine * sine / (1.0 + cosine)};
    }
  };

  static float density(const Seen& seen) {
    const double pdf = 1.0 / seen.cone.solid_angle();
    return pdf <= std::numeric_limits<float>::max() ? static_cast<float>(pdf) : 0.0f;
  }
};

}  // namespace becalm::tracer
