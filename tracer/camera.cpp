#include "tracer/camera.h"

namespace becalm::tracer {

namespace {

V2f sample_disc(const V2f& u) {
  const float x = 2.0f * u.x - 1.0f, y = 2.0f * u.y - 1.0f;
  if (x == 0.0f && y == 0.0f) return V2f(0.0f);
  constexpr float quarter = std::numbers::pi_v<float> / 4.0f;
  const bool wide = std::abs(x) > std::abs(y);
  const float radius = wide ? x : y;
  const float angle = wide ? quarter * (y / x) : 2.0f * quarter - quarter * (x / y);
  return V2f(std::cos(angle), std::sin(angle)) * radius;
}

V2f sample_polygon(int sides, float rotation, const V2f& u) {
  // One of the triangles between the centre and a side, then a point uniform over it.
  const float scaled = u.x * static_cast<float>(sides);
  const float side = std::min(std::floor(scaled), static_cast<float>(sides - 1));
  const float root = std::sqrt(scaled - side);
  const float step = 2.0f * std::numbers::pi_v<float> / static_cast<float>(sides);
  const float from = rotation + side * step;
  const V2f a(std::cos(from), std::sin(from)), b(std::cos(from + step), std::sin(from + step));
  return (a * (1.0f - u.y) + b * u.y) * root;
}

}  // namespace

V2f sample_aperture(int blades, float rotation, const V2f& u) {
  return blades < 3 ? sample_disc(u) : sample_polygon(blades, rotation, u);
}

}  // namespace becalm::tracer
