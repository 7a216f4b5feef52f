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
/// Rise of the threshold from the base to the box's top.
constexpr float kTopThreshold = 1.6f;
/// Rise of the threshold towards the border. The factor min(1, kRimSlope * rim) removes what is left there.
constexpr float kRimThreshold = 1.0f;
constexpr float kRimSlope = 4.0f;
/// Weight of the first octave, and the factor of its frequency along y: lower, so that clouds rest on their
/// base and few float free.
constexpr float kFieldWeight = 1.5f;
constexpr double kFieldStretch = 0.75;
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

}  // namespace

CloudDensity::CloudDensity(const CloudShape& shape)
    : shape_(shape), bias_(kClearBias + shape.coverage * (kOvercastBias - kClearBias)) {
  double scale = 1.0;
  float amplitude = kDetailWeight;
  for (int i = 0; i < shape.octaves; ++i) {
    Octave& octave = octaves_[i];
    octave.frequency = V3d(shape.frequency) * scale;
    // An eddy's turnover time falls with its size to the power 2/3 (Kolmogorov 1941): small bulges live
    // short.
    octave.evolution = shape.evolution * std::pow(scale, 2.0 / 3.0);
    octave.seed =
        static_cast<std::uint32_t>(mix_bits(std::uint64_t{shape.seed} << 32 | static_cast<unsigned>(i)));
    octave.amplitude = i == 0 ? kFieldWeight : amplitude *= shape.gain;
    scale *= shape.lacunarity;
  }
  octaves_[0].frequency.y *= kFieldStretch;
  float remaining = 0.0f;
  for (int i = shape.octaves - 1; i >= 0; --i) {
    octaves_[i].remaining = remaining += octaves_[i].amplitude;
  }
}

float CloudDensity::noise(int octave, const V3f& point) const {
  const V3d p = (V3d(point) - V3d(shape_.offset)) * octaves_[octave].frequency;
  return gradient_noise({p.x, p.y, p.z, octaves_[octave].evolution}, octaves_[octave].seed);
}

float CloudDensity::operator()(const V3f& point) const {
  const float side = 1.0f - std::max(std::abs(point.x), std::abs(point.z));
  const float height = 0.5f * (point.y + 1.0f);
  if (side <= 0.0f || height <= kBaseHeight || height >= 1.0f) return 0.0f;

  const float above_base = (height - kBaseHeight) / (1.0f - kBaseHeight);
  const float rim = smooth_step(0.0f, shape_.edge, side) * (1.0f - smooth_step(kTopFade, 1.0f, height));
  float field = bias_ - kTopThreshold * above_base * above_base - kRimThreshold * (1.0f - rim);
  field += octaves_[0].amplitude * noise(0, point);
  for (int i = 1; i < shape_.octaves; ++i) {
    // Most points are clear or solid whatever the octaves to come add.
    const Octave& octave = octaves_[i];
    if (field + octave.remaining * kBillowBound <= 0.0f ||
        field - octave.remaining * kBillowMean >= shape_.softness) {
      break;
    }
    field += octave.amplitude * (std::abs(noise(i, point)) - kBillowMean);
  }
  return std::clamp(field / shape_.softness, 0.0f, 1.0f) * std::min(1.0f, kRimSlope * rim) *
         smooth_step(kBaseHeight, kBaseSolid, height);
}

DensityGrid bake_cloud(const CloudShape& shape) {
  const V3i& size = shape.resolution;
  const CloudDensity density(shape);
  std::vector<float> values(static_cast<std::size_t>(size.x) * size.y * size.z);
  const auto coordinate = [&](int i, int axis) {
    return 2.0f * static_cast<float>(i) / static_cast<float>(size[axis] - 1) - 1.0f;
  };
  tbb::parallel_for(0, size.z * size.y, [&](int row) {
    float* value = &values[static_cast<std::size_t>(row) * size.x];
    const float y = coordinate(row % size.y, 1);
    const float z = coordinate(row / size.y, 2);
    for (int x = 0; x < size.x; ++x) *value++ = density({coordinate(x, 0), y, z});
  });
  return {size, std::move(values)};
}

}  // namespace becalm::tracer
