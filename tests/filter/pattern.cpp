#include "tests/filter/pattern.h"

#include <cstdint>

namespace becalm {
namespace {

double lattice(std::int64_t x, std::int64_t y, unsigned seed) {
  std::uint64_t h = std::uint64_t(x) * 0x9E3779B97F4A7C15u ^ std::uint64_t(y) * 0xC2B2AE3D27D4EB4Fu ^ seed;
  h = (h ^ (h >> 31)) * 0xD6E8FEB86659FD93u;
  h = (h ^ (h >> 32)) * 0xD6E8FEB86659FD93u;
  return static_cast<double>(h >> 40) / static_cast<double>(1 << 24);
}

double value_noise(double x, double y, unsigned seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ease = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const double tx = ease(x - fx), ty = ease(y - fy);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  return (1 - ty) * ((1 - tx) * lattice(ix, iy, seed) + tx * lattice(ix + 1, iy, seed)) +
         ty * ((1 - tx) * lattice(ix, iy + 1, seed) + tx * lattice(ix + 1, iy + 1, seed));
}

}  // namespace

double pattern(double x, double y, unsigned seed) {
  return 0.4 * value_noise(x / 6, y / 6, seed) + 0.3 * value_noise(x / 24, y / 24, seed + 1) +
         0.3 * value_noise(x / 96, y / 96, seed + 2);
}

reference::Grid<double> pattern_image(int width, int height, reference::Vec2 shift, unsigned seed) {
  reference::Grid<double> image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at(x, y) = pattern(x + shift.x, y + shift.y, seed);
  }
  return image;
}

}  // namespace becalm
