#include "tracer/procedural/terrain_noise.h"

#include <algorithm>
#include <cmath>

#include "tracer/procedural/vector_math.h"
#include "tracer/sampling/sobol.h"

namespace becalm::tracer {

namespace {

/// A value and its derivatives.
struct Noise {
  float value, dx, dz;
};

std::uint64_t lattice_hash(std::int32_t i, std::int32_t j, std::uint32_t seed) {
  const std::uint64_t key = std::uint64_t{static_cast<std::uint32_t>(i)} << 32 | static_cast<std::uint32_t>(j);
  return mix_bits(key ^ std::uint64_t{seed} * 0x9e3779b97f4a7c15ull);
}

/// The k-th 16 bits of a hash, over [-1, 1).
float signed_part(std::uint64_t hash, int k) {
  return static_cast<float>((hash >> (16 * k)) & 0xffffu) * 0x1p-15f - 1.0f;
}

/// Gradient noise (Perlin, "Improving noise", 2002) with gradients from the square [-1,1]^2. Mostly within
/// [-0.7, 0.7].
Noise gradient_noise(float x, float z, std::uint32_t seed) {
  const float floor_x = std::floor(x), floor_z = std::floor(z);
  const std::int32_t i = static_cast<std::int32_t>(floor_x), j = static_cast<std::int32_t>(floor_z);
  const float u = x - floor_x, v = z - floor_z;
  float g[4][2], d[4];
  for (int k = 0; k < 4; ++k) {
    const std::uint64_t hash = lattice_hash(i + (k & 1), j + (k >> 1), seed);
    g[k][0] = signed_part(hash, 0);
    g[k][1] = signed_part(hash, 1);
    d[k] = g[k][0] * (u - static_cast<float>(k & 1)) + g[k][1] * (v - static_cast<float>(k >> 1));
  }
  const float fu = u * u * u * (u * (u * 6.0f - 15.0f) + 10.0f), fv = v * v * v * (v * (v * 6.0f - 15.0f) + 10.0f);
  const float su = 30.0f * u * u * (u - 1.0f) * (u - 1.0f), sv = 30.0f * v * v * (v - 1.0f) * (v - 1.0f);
  const auto mix = [&](float a, float b, float c, float e) {
    return (1.0f - fv) * (a + fu * (b - a)) + fv * (c + fu * (e - c));
  };
  return {mix(d[0], d[1], d[2], d[3]),
          mix(g[0][0], g[1][0], g[2][0], g[3][0]) + su * ((1.0f - fv) * (d[1] - d[0]) + fv * (d[3] - d[2])),
          mix(g[0][1], g[1][1], g[2][1], g[3][1]) + sv * ((1.0f - fu) * (d[2] - d[0]) + fu * (d[3] - d[1]))};
}

/// Stripes across `side` (their phase grows along it, |side| turns a unit): cosines around jittered points, one
/// in each unit cell, blended by weights that are 0 where a neighbour's neighbour begins.
Noise stripes(float x, float z, float side_x, float side_z, std::uint32_t seed) {
  const float floor_x = std::floor(x), floor_z = std::floor(z);
  const std::int32_t i = static_cast<std::int32_t>(floor_x), j = static_cast<std::int32_t>(floor_z);
  float weights = 0.0f, value = 0.0f, rise = 0.0f;
  for (int dj = -1; dj <= 1; ++dj) {
    for (int di = -1; di <= 1; ++di) {
      const std::uint64_t hash = lattice_hash(i + di, j + dj, seed);
      const float px = x - (floor_x + static_cast<float>(di) + 0.5f + 0.3f * signed_part(hash, 0));
      const float pz = z - (floor_z + static_cast<float>(dj) + 0.5f + 0.3f * signed_part(hash, 1));
      const float room = std::max(0.0f, 1.0f - (px * px + pz * pz) * (1.0f / 1.44f));
      const float weight = room * room * room;
      const SinCos wave = sin_cos_turns(px * side_x + pz * side_z);
      weights += weight;
      value += weight * wave.cos;
      rise -= weight * wave.sin;
    }
  }
  const float per_weight = 1.0f / weights;
  return {value * per_weight, rise * per_weight * side_x, rise * per_weight * side_z};
}

}  // namespace

float terrain_height(const TerrainShape& shape, float x, float z) {
  constexpr int kMassifOctaves = 3;  // the rest carve
  const float highest = 0.5f * shape.resolution;
  float frequency = shape.mountains, amplitude = 1.0f;
  Noise land{0.0f, 0.0f, 0.0f};
  int octave = 0;
  for (; octave < std::min(shape.octaves, kMassifOctaves) && frequency < highest; ++octave) {
    const Noise n = gradient_noise(x * frequency, z * frequency, shape.seed + static_cast<std::uint32_t>(octave));
    land.value += amplitude * n.value;
    land.dx += amplitude * frequency * n.dx;
    land.dz += amplitude * frequency * n.dz;
    frequency *= 2.0f;
    amplitude *= 0.42f;
  }
  // Gullies run down the slope that coarser ones left: an idea of Clay John, "Eroded terrain noise", 2018. Differs: the
  // stripes' frequency saturates with the slope, so that summits and valley floors fade into smooth ground.
  const float per_mountains = 1.0f / shape.mountains;
  frequency = shape.mountains * 3.0f;
  amplitude = 0.20f * shape.erosion;
  float carved = land.value, dx = land.dx, dz = land.dz;
  for (; octave < shape.octaves && frequency < highest; ++octave) {
    const float sx = dx * per_mountains, sz = dz * per_mountains;
    const float slope = std::sqrt(sx * sx + sz * sz);
    const float steepness = slope / (slope + 0.25f);
    const float per_slope = steepness / std::max(slope, 1e-6f);
    const Noise n = stripes(x * frequency, z * frequency, -sz * per_slope * 0.8f, sx * per_slope * 0.8f,
                            shape.seed + 64u + static_cast<std::uint32_t>(octave));
    carved += amplitude * steepness * n.value;
    dx += amplitude * steepness * frequency * n.dx;
    dz += amplitude * steepness * frequency * n.dz;
    frequency *= 2.0f;
    amplitude *= 0.5f;
  }
  return 0.5f + 0.6f * carved;
}

}  // namespace becalm::tracer
