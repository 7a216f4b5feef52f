#include "tracer/procedural/terrain_noise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tracer/procedural/vector_math.h"
#include "tracer/sampling/sobol.h"

namespace becalm::tracer {

namespace {

// Tuned by eye for four mountains a side.
constexpr int kMassifOctaves = 3;     ///< of smooth noise; the rest are gullies
constexpr float kMassifGain = 0.45f;  ///< amplitude from octave to octave
constexpr float kFirstGully = 3.0f;   ///< frequency of the coarsest, in mountains
constexpr float kGullyDepth = 0.10f;
constexpr float kGullyGain = 0.52f;
constexpr float kGullySlope = 0.25f;  ///< at which gullies have half their depth, in heights a mountain
constexpr float kStripeTurns = 0.8f;  ///< of a gully's wave in its period

constexpr float kCellsAPeriod =
    5.0f;  ///< that an octave is sampled with at least, while the grid can be refined
constexpr int kCoarsestCells = 16;

std::uint64_t lattice_hash(std::int32_t i, std::int32_t j, std::uint32_t seed) {
  const std::uint64_t key =
      std::uint64_t{static_cast<std::uint32_t>(i)} << 32 | static_cast<std::uint32_t>(j);
  return mix_bits(key ^ std::uint64_t{seed} * 0x9e3779b97f4a7c15ull);
}

/// The k-th 16 bits of a hash, over [-1, 1).
float signed_part(std::uint64_t hash, int k) {
  return static_cast<float>((hash >> (16 * k)) & 0xffffu) * 0x1p-15f - 1.0f;
}

/// Gradient noise (Perlin, "Improving noise", 2002) with gradients from the square [-1,1]^2. Mostly within
/// [-0.7, 0.7].
float gradient_noise(float x, float z, std::uint32_t seed) {
  const float floor_x = std::floor(x), floor_z = std::floor(z);
  const std::int32_t i = static_cast<std::int32_t>(floor_x), j = static_cast<std::int32_t>(floor_z);
  const float u = x - floor_x, v = z - floor_z;
  float d[4];
  for (int k = 0; k < 4; ++k) {
    const std::uint64_t hash = lattice_hash(i + (k & 1), j + (k >> 1), seed);
    d[k] = signed_part(hash, 0) * (u - static_cast<float>(k & 1)) +
           signed_part(hash, 1) * (v - static_cast<float>(k >> 1));
  }
  const float fu = u * u * u * (u * (u * 6.0f - 15.0f) + 10.0f);
  const float fv = v * v * v * (v * (v * 6.0f - 15.0f) + 10.0f);
  return (1.0f - fv) * (d[0] + fu * (d[1] - d[0])) + fv * (d[2] + fu * (d[3] - d[2]));
}

/// The origins of the waves in the three by three cells around one, filled up to 12 with origins too far away
/// to weigh anything.
struct StripeOrigins {
  static constexpr int kCount = 12;

  void move_to(std::int32_t i, std::int32_t j, std::uint32_t seed) {
    if (filled && i == cell_i && j == cell_j) return;
    cell_i = i;
    cell_j = j;
    filled = true;
    for (int k = 0; k < kCount; ++k) {
      if (k >= 9) {
        x[k] = z[k] = 1e3f;
        continue;
      }
      const int di = k % 3 - 1, dj = k / 3 - 1;
      const std::uint64_t hash = lattice_hash(i + di, j + dj, seed);
      x[k] = static_cast<float>(di) + 0.5f + 0.3f * signed_part(hash, 0);
      z[k] = static_cast<float>(dj) + 0.5f + 0.3f * signed_part(hash, 1);
    }
  }

  bool filled = false;
  std::int32_t cell_i = 0, cell_j = 0;
  float x[kCount], z[kCount];  ///< from the cell's lower corner
};

/// Stripes whose phase grows by (side_x, side_z) turns a unit: cosines around one jittered origin in each
/// unit cell, blended by weights that are 0 at the origins of cells beyond the next.
float stripes(float x, float z, float side_x, float side_z, std::uint32_t seed, StripeOrigins& origins) {
  const float floor_x = std::floor(x), floor_z = std::floor(z);
  origins.move_to(static_cast<std::int32_t>(floor_x), static_cast<std::int32_t>(floor_z), seed);
  const float u = x - floor_x, v = z - floor_z;
  float weights[4] = {}, values[4] = {};
  for (int k = 0; k < StripeOrigins::kCount; k += 4) {
    for (int lane = 0; lane < 4; ++lane) {
      const float px = u - origins.x[k + lane], pz = v - origins.z[k + lane];
      const float left = 1.0f - (px * px + pz * pz) * (1.0f / 1.44f);
      const float room = left > 0.0f ? left : 0.0f;
      const float weight = room * room * room;
      weights[lane] += weight;
      values[lane] += weight * sin_cos_turns(room > 0.0f ? px * side_x + pz * side_z : 0.0f).cos;
    }
  }
  return ((values[0] + values[2]) + (values[1] + values[3])) /
         ((weights[0] + weights[2]) + (weights[1] + weights[3]));
}

/// Controls of a spline of `cells` cells a side, with the ring around.
struct Grid {
  explicit Grid(int cells)
      : cells(cells), values(static_cast<std::size_t>(cells + 2) * static_cast<std::size_t>(cells + 2)) {}

  float* row(int j) {
    return &values[static_cast<std::size_t>(j + 1) * static_cast<std::size_t>(cells + 2) + 1];
  }
  const float* row(int j) const { return const_cast<Grid*>(this)->row(j); }

  int cells;
  std::vector<float> values;
};

/// Runs body(j) for all rows of the grid, with the ring, in parallel.
template <class Body>
void for_rows(const Grid& grid, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<int>(-1, grid.cells + 1, 8), [&](const tbb::blocked_range<int>& rows) {
    for (int j = rows.begin(); j != rows.end(); ++j) body(j);
  });
}

/// Mountains and their main ridges, from a few octaves.
Grid make_massif(const TerrainShape& shape, int octaves, int cells) {
  Grid grid(cells);
  const float per_cell = 1.0f / static_cast<float>(cells);
  for_rows(grid, [&](int j) {
    float* row = grid.row(j);
    const float z = (static_cast<float>(j) + 0.5f) * per_cell;
    for (int i = -1; i <= cells; ++i) {
      const float x = (static_cast<float>(i) + 0.5f) * per_cell;
      float frequency = shape.mountains, amplitude = 1.0f, height = 0.0f;
      for (int octave = 0; octave < octaves; ++octave) {
        const std::uint32_t seed = shape.seed * 64u + static_cast<std::uint32_t>(octave);
        // The coarsest octave says where mountains are, the others fold into ridges.
        const float noise = gradient_noise(x * frequency, z * frequency, seed);
        height += amplitude * (octave == 0 ? noise : 0.3f - 1.5f * std::abs(noise));
        frequency *= 2.0f;
        amplitude *= kMassifGain;
      }
      // Squaring steepens summits and flattens valleys.
      const float above = std::max(0.0f, 0.55f + 0.55f * height);
      row[i] = above * (0.3f + 0.7f * above);
    }
  });
  return grid;
}

/// The same surface by twice as many cells a side: Chaikin's subdivision along both axes.
Grid refined(const Grid& coarse) {
  Grid fine(2 * coarse.cells);
  for_rows(fine, [&](int j) {
    // Odd controls lean to the next coarse one, even ones to the one before.
    const int near_j = j >> 1, far_j = j & 1 ? near_j + 1 : near_j - 1;
    const float* near_row = coarse.row(near_j);
    const float* far_row = coarse.row(far_j);
    float* row = fine.row(j);
    for (int i = -1; i <= fine.cells; ++i) {
      const int near_i = i >> 1, far_i = i & 1 ? near_i + 1 : near_i - 1;
      row[i] = 0.75f * (0.75f * near_row[near_i] + 0.25f * near_row[far_i]) +
               0.25f * (0.75f * far_row[near_i] + 0.25f * far_row[far_i]);
    }
  });
  return fine;
}

/// Gullies run down the slope that coarser ones left: an idea of Clay John, "Eroded terrain noise", 2018.
/// Differs: the stripes' frequency and depth saturate with the slope, so that summits and valley floors stay
/// smooth, and slopes are those of the surface so far instead of a sum of derivatives.
Grid carved(const TerrainShape& shape, const Grid& land, int octave, float frequency, float amplitude) {
  Grid result = land;
  const int n = land.cells;
  const float per_cell = 1.0f / static_cast<float>(n);
  const float per_slope_unit = 0.5f * static_cast<float>(n) / shape.mountains;
  const std::uint32_t seed = shape.seed * 64u + 32u + static_cast<std::uint32_t>(octave);
  for_rows(result, [&](int j) {
    StripeOrigins origins;
    // The ring has no neighbours outside: it takes the slope beside it.
    const int jn = std::clamp(j, 0, n - 1);
    const float *before = land.row(jn - 1), *here = land.row(jn), *after = land.row(jn + 1);
    float* row = result.row(j);
    for (int i = -1; i <= n; ++i) {
      const int in = std::clamp(i, 0, n - 1);
      const float sx = (here[in + 1] - here[in - 1]) * per_slope_unit;
      const float sz = (after[in] - before[in]) * per_slope_unit;
      const float slope = std::sqrt(sx * sx + sz * sz);
      const float steepness = slope / (slope + kGullySlope);
      const float turns = kStripeTurns * steepness / std::max(slope, 1e-6f);
      const float x = (static_cast<float>(i) + 0.5f) * per_cell,
                  z = (static_cast<float>(j) + 0.5f) * per_cell;
      row[i] += amplitude * steepness *
                stripes(x * frequency, z * frequency, -sz * turns, sx * turns, seed, origins);
    }
  });
  return result;
}

}  // namespace

std::vector<float> make_mountains(const TerrainShape& shape) {
  const float highest = static_cast<float>(shape.resolution) / 3.0f;
  int massif_octaves = 1;
  while (massif_octaves < std::min(shape.octaves, kMassifOctaves) &&
         shape.mountains * static_cast<float>(1 << massif_octaves) < highest) {
    ++massif_octaves;
  }
  // Each octave is added on the coarsest grid that holds it well; finer ones continue from there.
  int cells = shape.resolution;
  const auto holds = [&](int count, float frequency) {
    return static_cast<float>(count) >= kCellsAPeriod * frequency;
  };
  float frequency = shape.mountains * static_cast<float>(1 << (massif_octaves - 1));
  // Ridges are creases, for which a few cells are not enough.
  while (cells > kCoarsestCells && holds(cells / 8, frequency)) cells /= 2;
  Grid land = make_massif(shape, massif_octaves, cells);
  frequency = shape.mountains * kFirstGully;
  float amplitude = kGullyDepth * shape.erosion;
  for (int octave = massif_octaves; octave < shape.octaves && frequency < highest; ++octave) {
    while (land.cells < shape.resolution && !holds(land.cells, frequency)) land = refined(land);
    land = carved(shape, land, octave, frequency, amplitude);
    frequency *= 2.0f;
    amplitude *= kGullyGain;
  }
  while (land.cells < shape.resolution) land = refined(land);
  return std::move(land.values);
}

}  // namespace becalm::tracer
