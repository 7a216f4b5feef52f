#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A point of the noise's domain: three coordinates of space and one along which the noise evolves. Lattice
/// points are at integers.
using NoisePoint = std::array<double, 4>;

/// The 32 vectors of one zero and three +-1: the centres of a hypercube's edges.
inline constexpr std::array<std::array<float, 4>, 32> kNoiseGradients = [] {
  std::array<std::array<float, 4>, 32> gradients{};
  for (int i = 0; i < 32; ++i) {
    int sign = 1;
    for (int a = 0; a < 4; ++a) {
      if (a == i / 8) continue;
      gradients[i][a] = (i & sign) != 0 ? -1.0f : 1.0f;
      sign *= 2;
    }
  }
  return gradients;
}();

/// Gradient noise in four dimensions: C2, 0 at lattice points, within [-1,1] up to a few percent and mostly
/// within 0.6 of 0. A pure function of point and seed, by integer hashing alone. Coordinates up to 2^52 in
/// size. Source: Perlin, "Improving noise", 2002, with the gradients of four dimensions.
inline float gradient_noise(const NoisePoint& p, std::uint32_t seed) {
  constexpr std::array<std::uint32_t, 4> primes = {0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du, 0x27d4eb2fu};
  std::uint32_t hash[4][2];
  float f[4];
  float fade[4];
  for (int a = 0; a < 4; ++a) {
    const double floor = std::floor(p[a]);
    const auto cell = static_cast<std::uint32_t>(static_cast<std::int64_t>(floor));
    hash[a][0] = cell * primes[a];
    hash[a][1] = hash[a][0] + primes[a];
    f[a] = static_cast<float>(p[a] - floor);
    fade[a] = f[a] * f[a] * f[a] * (f[a] * (f[a] * 6.0f - 15.0f) + 10.0f);
  }
  const auto corner = [&](int x, std::uint32_t hash_yzw, const float* rest) {
    std::uint32_t h = hash[0][x] ^ hash_yzw;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    const auto& gradient = kNoiseGradients[h >> 27];
    return gradient[0] * (f[0] - static_cast<float>(x)) + gradient[1] * rest[0] + gradient[2] * rest[1] +
           gradient[3] * rest[2];
  };
  float sum_w[2];
  for (int w = 0; w < 2; ++w) {
    float sum_z[2];
    for (int z = 0; z < 2; ++z) {
      float sum_y[2];
      for (int y = 0; y < 2; ++y) {
        const std::uint32_t hash_yzw = seed ^ hash[1][y] ^ hash[2][z] ^ hash[3][w];
        const float rest[3] = {f[1] - static_cast<float>(y), f[2] - static_cast<float>(z),
                               f[3] - static_cast<float>(w)};
        const float low = corner(0, hash_yzw, rest);
        sum_y[y] = low + fade[0] * (corner(1, hash_yzw, rest) - low);
      }
      sum_z[z] = sum_y[0] + fade[1] * (sum_y[1] - sum_y[0]);
    }
    sum_w[w] = sum_z[0] + fade[2] * (sum_z[1] - sum_z[0]);
  }
  return sum_w[0] + fade[3] * (sum_w[1] - sum_w[0]);
}

}  // namespace becalm::tracer
