#include "tracer/procedural/terrain.h"

#include <tbb/parallel_for.h>

#include "tracer/procedural/height_trace.h"
#include "tracer/procedural/spline_patch.h"
#include "tracer/procedural/unit_ray.h"

namespace becalm::tracer {

namespace {

constexpr int kCoarsest = 8;  ///< cells a side of the coarsest spline that normals come from

/// Runs body(row) for all rows in parallel.
template <class Body>
void for_rows(int first, int last, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<int>(first, last, 16), [&](const tbb::blocked_range<int>& rows) {
    for (int row = rows.begin(); row != rows.end(); ++row) body(row);
  });
}

}  // namespace

bool Terrain::update(const TerrainDescription& description, double frame) {
  const auto scale_at = [&](double at) {
    return static_cast<float>(description.height.at(at)[0] / description.size);
  };
  const float scale = scale_at(frame);
  scale_before_ = scale_at(frame - 1.0);
  const TerrainShape shape{description.seed, static_cast<float>(description.mountains), description.octaves,
                           static_cast<float>(description.erosion.at(frame)[0]), description.resolution};
  const bool same_noise = !levels_.empty() && shape == shape_;
  if (same_noise && scale == scale_ && description.size == size_) return false;
  size_ = description.size;
  scale_ = scale;
  if (!same_noise) {
    shape_ = shape;
    bake();
  }
  tolerance_ = height_tolerance(scale);
  return true;
}

void Terrain::bake() {
  levels_.resize(1);
  levels_[0] = {shape_.resolution, make_mountains(shape_), {}};
  bake_ranges();
  while (levels_.back().resolution > kCoarsest) {
    Level coarse;
    bake_coarser(levels_.back(), coarse);
    levels_.push_back(std::move(coarse));
  }
}

/// Stores ranges of blocks of two by two cells and more.
void Terrain::bake_ranges() {
  const Level& finest = levels_[0];
  pyramid_.resize(finest.resolution, 1);
  for_rows(0, pyramid_.resolution(1), [&](int j) {
    for (int i = 0; i < pyramid_.resolution(1); ++i) {
      const float* first =
          &finest
               .controls[static_cast<std::size_t>(2 * j) * finest.stride() + static_cast<std::size_t>(2 * i)];
      HeightRange range{*first, *first};
      for (std::size_t row = 0; row < 4; ++row) {
        const auto [low, high] =
            std::minmax_element(first + row * finest.stride(), first + row * finest.stride() + 4);
        range = {std::min(range.low, *low), std::max(range.high, *high)};
      }
      pyramid_.at(1, i, j) = range;
    }
  });
  pyramid_.reduce();
}

void Terrain::bake_coarser(const Level& fine, Level& coarse) {
  const int n = coarse.resolution = fine.resolution / 2;
  coarse.controls.resize(coarse.stride() * coarse.stride());
  coarse.squared_slope.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  const auto fine_at = [&](int i, int j) {
    return fine.controls[static_cast<std::size_t>(j + 1) * fine.stride() + static_cast<std::size_t>(i + 1)];
  };
  const auto fine_squared_slope = [&](int i, int j) {
    if (!fine.squared_slope.empty()) {
      return fine.squared_slope[static_cast<std::size_t>(j) * static_cast<std::size_t>(fine.resolution) +
                                static_cast<std::size_t>(i)];
    }
    const float per_side = 0.5f * static_cast<float>(fine.resolution);
    const float dx = (fine_at(i + 1, j) - fine_at(i - 1, j)) * per_side;
    const float dz = (fine_at(i, j + 1) - fine_at(i, j - 1)) * per_side;
    return dx * dx + dz * dz;
  };
  for_rows(0, n, [&](int j) {
    for (int i = 0; i < n; ++i) {
      const int a = 2 * i, b = 2 * j;
      coarse.controls[static_cast<std::size_t>(j + 1) * coarse.stride() + static_cast<std::size_t>(i + 1)] =
          0.25f * (fine_at(a, b) + fine_at(a + 1, b) + fine_at(a, b + 1) + fine_at(a + 1, b + 1));
      coarse.squared_slope[static_cast<std::size_t>(j) * static_cast<std::size_t>(n) +
                           static_cast<std::size_t>(i)] =
          0.25f * (fine_squared_slope(a, b) + fine_squared_slope(a + 1, b) + fine_squared_slope(a, b + 1) +
                   fine_squared_slope(a + 1, b + 1));
    }
  });
  // The ring continues the slope at the border.
  const std::size_t s = coarse.stride();
  for (std::size_t k = 1; k + 1 < s; ++k) {
    float* row = &coarse.controls[k * s];
    row[0] = 2.0f * row[1] - row[2];
    row[s - 1] = 2.0f * row[s - 2] - row[s - 3];
  }
  for (std::size_t k = 0; k < s; ++k) {
    float* first = &coarse.controls[k];
    first[0] = 2.0f * first[s] - first[2 * s];
    first[(s - 1) * s] = 2.0f * first[(s - 2) * s] - first[(s - 3) * s];
  }
}

Imath::Box3f Terrain::unit_bounds() const {
  const HeightRange all = pyramid_.all();
  // Padded by more than rounding may hide.
  const float pad = 4.0f * tolerance_;
  return {V3f(0.0f, scale_ * all.low - pad, 0.0f), V3f(1.0f, scale_ * all.high + pad, 1.0f)};
}

Imath::Box3f Terrain::bounds() const {
  const Imath::Box3f unit = unit_bounds();
  const auto outer = [this](double v) { return static_cast<float>(v * size_); };
  return {V3f(outer(-0.5), outer(unit.min.y), outer(-0.5)), V3f(outer(0.5), outer(unit.max.y), outer(0.5))};
}

std::optional<float> Terrain::intersect(const V3f& origin, const V3f& dir, float t_min, float t_max) const {
  Imath::Box3f box = unit_bounds();
  box.min -= V3f(0.5f, 0.0f, 0.5f);
  box.max -= V3f(0.5f, 0.0f, 0.5f);
  auto ray = clip_ray(origin, dir, t_min, t_max, size_, box);
  if (!ray) return std::nullopt;
  ray->origin += V3f(0.5f, 0.0f, 0.5f);
  const Level& finest = levels_[0];
  const float n = static_cast<float>(finest.resolution);
  const float du = ray->dir.x * n, dv = ray->dir.z * n;
  const auto t =
      trace_heights(pyramid_, *ray, scale_, tolerance_, [&](int i, int j, float& t, float t1, Side& side) {
        const SplinePatch patch(
            &finest.controls[static_cast<std::size_t>(j) * finest.stride() + static_cast<std::size_t>(i)],
            finest.stride());
        const float u = ray->origin.x * n - static_cast<float>(i),
                    v = ray->origin.z * n - static_cast<float>(j);
        const float curvature = scale_ * patch.curvature(du, dv);
        const auto look = [&](float t, Side& side) {
          const HeightSlope h = patch.at(u + t * du, v + t * dv);
          const float value = ray->origin.y + t * ray->dir.y - scale_ * h.height;
          if (side == Side::unknown) side = side_of(value);
          const float sign = static_cast<float>(side);
          return Ahead{sign * value, sign * (ray->dir.y - scale_ * (h.slope_x * du + h.slope_z * dv)),
                       curvature};
        };
        return march(look, t, t1, tolerance_, side);
      });
  if (!t) return std::nullopt;
  return ray->outer_t(*t);
}

HeightSlope Terrain::heights_at(const Level& level, float x, float z) const {
  const float n = static_cast<float>(level.resolution);
  const float u = x * n, v = z * n;
  const int i = std::clamp(static_cast<int>(u), 0, level.resolution - 1);
  const int j = std::clamp(static_cast<int>(v), 0, level.resolution - 1);
  const SplinePatch patch(
      &level.controls[static_cast<std::size_t>(j) * level.stride() + static_cast<std::size_t>(i)],
      level.stride());
  const HeightSlope h = patch.at(u - static_cast<float>(i), v - static_cast<float>(j));
  return {h.height, h.slope_x * n, h.slope_z * n};
}

Terrain::Averaged Terrain::averaged_at(const Level& level, float x, float z) const {
  const HeightSlope h = heights_at(level, x, z);
  const float own = h.slope_x * h.slope_x + h.slope_z * h.slope_z;
  if (level.squared_slope.empty()) return {h.slope_x, h.slope_z, own};
  const float n = static_cast<float>(level.resolution);
  const int i = std::clamp(static_cast<int>(x * n), 0, level.resolution - 1);
  const int j = std::clamp(static_cast<int>(z * n), 0, level.resolution - 1);
  return {
      h.slope_x, h.slope_z,
      std::max(own,
               level.squared_slope[static_cast<std::size_t>(j) * static_cast<std::size_t>(level.resolution) +
                                   static_cast<std::size_t>(i)])};
}

/// Between the two levels whose cells are next to the footprint.
Terrain::Averaged Terrain::averaged_at(float x, float z, float footprint) const {
  const float last = static_cast<float>(levels_.size() - 1);
  const float cells = footprint * static_cast<float>(levels_[0].resolution);
  const float lod = cells > 1.0f ? std::min(std::log2(cells), last) : 0.0f;
  const std::size_t level = static_cast<std::size_t>(lod);
  const float w = lod - static_cast<float>(level);
  const Averaged a = averaged_at(levels_[level], x, z);
  if (w == 0.0f) return a;
  const Averaged b = averaged_at(levels_[level + 1], x, z);
  return {a.slope_x + w * (b.slope_x - a.slope_x), a.slope_z + w * (b.slope_z - a.slope_z),
          a.squared_slope + w * (b.squared_slope - a.squared_slope)};
}

ProceduralPoint Terrain::point(const V3f& p, float footprint) const {
  const float size = static_cast<float>(size_);
  const auto unit = [this](float v) { return std::clamp(static_cast<float>(v / size_ + 0.5), 0.0f, 1.0f); };
  const float x = unit(p.x), z = unit(p.z);
  const float height = scale_ * heights_at(levels_[0], x, z).height;
  const Averaged slope = averaged_at(x, z, footprint / size);
  const float sx = scale_ * slope.slope_x, sz = scale_ * slope.slope_z;
  const float own = slope.slope_x * slope.slope_x + slope.slope_z * slope.slope_z;
  const float variance = scale_ * scale_ * std::max(slope.squared_slope - own, 0.0f);
  return {V3f(p.x, height * size, p.z), V3f(-sx, 1.0f, -sz).normalized(), V2f(x, 1.0f - z),
          8.0f * tolerance_ * size, variance};
}

V3f Terrain::point_before(const V3f& p) const {
  return {p.x, scale_ > 0.0f ? p.y * (scale_before_ / scale_) : p.y, p.z};
}

std::size_t Terrain::bytes() const {
  std::size_t total = pyramid_.bytes();
  for (const Level& level : levels_) {
    total += (level.controls.capacity() + level.squared_slope.capacity()) * sizeof(float);
  }
  return total;
}

}  // namespace becalm::tracer
