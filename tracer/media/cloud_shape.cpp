#include "tracer/media/cloud_shape.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tracer/media/gradient_noise.h"
#include "tracer/sampling/sobol.h"

namespace becalm::tracer {

namespace {

/// Share of the box's height that lies below the clouds' base, and where the base has become solid.
constexpr float kBaseHeight = 0.08f;
constexpr float kBaseSolid = 0.14f;
/// Share of the box's height above which clouds are thinned out, so that the highest are not cut off.
constexpr float kTopFade = 0.8f;
/// What the threshold gains from the base to the box's top.
constexpr float kTopThreshold = 1.6f;
/// What the threshold gains towards the border. Together with the factor min(1, kRimSlope * rim), which takes
/// away what is left there.
constexpr float kRimThreshold = 1.0f;
constexpr float kRimSlope = 4.0f;
/// Weight of the first octave.
constexpr float kFieldWeight = 1.5f;
/// The field's bias at coverage 0 and 1.
constexpr float kClearBias = -1.2f;
constexpr float kOvercastBias = 0.6f;
/// Mean of a billow octave, |noise|, which is taken off so that detail neither grows nor shrinks the clouds,
/// and a bound of what is left: |noise| < 1.1.
constexpr float kBillowMean = 0.2f;
constexpr float kBillowBound = 0.9f;
/// Weight of the detail beside the first octave.
constexpr float kDetailWeight = 1.2f;

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

NoisePoint noise_point(const CloudShape& shape, const V3f& point, int octave) {
  const double scale = std::pow(shape.lacunarity, octave);
  NoisePoint p;
  for (int a = 0; a < 3; ++a) p[a] = (double{point[a]} - shape.offset[a]) * shape.frequency[a] * scale;
  // An eddy's turnover time falls with its size to the power 2/3 (Kolmogorov 1941): small bulges live short.
  p[3] = shape.evolution * std::pow(scale, 2.0 / 3.0);
  return p;
}

std::uint32_t octave_seed(const CloudShape& shape, int octave) {
  return static_cast<std::uint32_t>(
      mix_bits(std::uint64_t{shape.seed} << 32 | static_cast<unsigned>(octave)));
}

}  // namespace

float cloud_density(const CloudShape& shape, const V3f& point) {
  const float side = 1.0f - std::max(std::abs(point.x), std::abs(point.z));
  const float height = 0.5f * (point.y + 1.0f);
  if (side <= 0.0f || height <= kBaseHeight || height >= 1.0f) return 0.0f;

  const float above_base = (height - kBaseHeight) / (1.0f - kBaseHeight);
  const float bias = kClearBias + shape.coverage * (kOvercastBias - kClearBias);
  const float rim = smooth_step(0.0f, shape.edge, side) * (1.0f - smooth_step(kTopFade, 1.0f, height));
  float field = bias - kTopThreshold * above_base * above_base;
  field -= kRimThreshold * (1.0f - rim);
  // Slower along y: clouds stand on their base, and few fly off.
  const V3f flattened(point.x, 0.75f * point.y, point.z);
  field += kFieldWeight * gradient_noise(noise_point(shape, flattened, 0), octave_seed(shape, 0));

  float remaining = 0.0f;  // amplitude of the octaves to come
  for (int octave = shape.octaves - 1; octave > 0; --octave) {
    remaining = shape.gain * (kDetailWeight + remaining);
  }
  float amplitude = kDetailWeight;
  for (int octave = 1; octave < shape.octaves; ++octave) {
    // Most points are clear or solid whatever the octaves to come add.
    if (field + remaining * kBillowBound <= 0.0f || field - remaining * kBillowMean >= shape.softness) break;
    amplitude *= shape.gain;
    remaining -= amplitude;
    const float noise = gradient_noise(noise_point(shape, point, octave), octave_seed(shape, octave));
    field += amplitude * (std::abs(noise) - kBillowMean);
  }
  return std::clamp(field / shape.softness, 0.0f, 1.0f) * std::min(1.0f, kRimSlope * rim) *
         smooth_step(kBaseHeight, kBaseSolid, height);
}

DensityGrid bake_cloud(const CloudShape& shape) {
  const V3i& size = shape.resolution;
  std::vector<float> values(static_cast<std::size_t>(size.x) * size.y * size.z);
  const auto coordinate = [&](int i, int axis) {
    return 2.0f * static_cast<float>(i) / static_cast<float>(size[axis] - 1) - 1.0f;
  };
  tbb::parallel_for(0, size.z * size.y, [&](int row) {
    float* value = &values[static_cast<std::size_t>(row) * size.x];
    const float y = coordinate(row % size.y, 1);
    const float z = coordinate(row / size.y, 2);
    for (int x = 0; x < size.x; ++x) *value++ = cloud_density(shape, {coordinate(x, 0), y, z});
  });
  return {size, std::move(values)};
}

}  // namespace becalm::tracer
