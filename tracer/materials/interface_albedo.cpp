#include "tracer/materials/interface_albedo.h"

#include <memory>
#include <mutex>

#include "tracer/materials/fresnel.h"
#include "tracer/materials/local_direction.h"
#include "tracer/materials/microfacet.h"

namespace becalm::tracer {

namespace {

constexpr int kIndices = 65;  ///< odd, so that 1 is a node
constexpr int kAlphas = 17;
constexpr int kCosines = 33;
constexpr Lattice kDirections{.points = 233, .before = 144};

/// The axis of indices: (n - 1) / (n + 1), by the root of its distance to 0 (an index of 1), where critical
/// angles change fastest.
float index_axis(float n) {
  const float ratio = (n - 1.0f) / (n + 1.0f);
  return 0.5f + 0.5f * std::copysign(std::sqrt(std::abs(ratio)), ratio);
}

float index_at(int node) {
  const float x = 2.0f * static_cast<float>(node) / static_cast<float>(kIndices - 1) - 1.0f;
  constexpr float largest = 0.999999f;
  const float ratio = std::clamp(x * std::abs(x), -largest, largest);
  return (1.0f + ratio) / (1.0f - ratio);
}

float integrate(float cosine, float alpha, float n) {
  if (alpha == 0.0f) return 1.0f;
  cosine = std::max(cosine, 1e-5f);  // the limit at the horizon is approached, not reached
  const V3f wo(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
  double sum = 0.0;
  for (int i = 0; i < kDirections.points; ++i) {
    const V3f m = ggx_sample_visible_normal(wo, alpha, kDirections.point(i));
    const float cos_m = std::clamp(wo.dot(m), 0.0f, 1.0f);
    float cos_t = 0.0f;
    const float reflected = fresnel_dielectric(cos_m, n, &cos_t);
    const V3f mirrored = reflect(wo, m);
    if (mirrored.z > 0.0f) sum += reflected * mirrored_weight(wo, mirrored, alpha);
    const V3f refracted = m * (cos_m / n - cos_t) - wo / n;
    if (reflected < 1.0f && refracted.z < 0.0f)
      sum += (1.0f - reflected) * -refracted.z * ggx_g1_over_cos(upper(refracted.normalized()), alpha);
  }
  return std::min(1.0f, static_cast<float>(sum / kDirections.points) + kAlbedoMargin);
}

}  // namespace

/// Of one index of refraction.
struct InterfaceAlbedo::Slice {
  std::array<std::array<float, kCosines>, kAlphas> albedo;
  std::array<float, kAlphas> mean;

  explicit Slice(float n) {
    const auto weights = cosine_weights<kCosines>();
    for (int i = 0; i < kAlphas; ++i) {
      double sum = 0.0;
      for (int j = 0; j < kCosines; ++j) {
        albedo[i][j] = integrate(squared_node(j, kCosines), squared_node(i, kAlphas), n);
        sum += weights[j] * albedo[i][j];
      }
      mean[i] = static_cast<float>(sum);
    }
  }

  float at(const TablePosition& alpha, const TablePosition& cosine) const {
    const auto &low = albedo[alpha.index], &high = albedo[alpha.index + 1];
    return alpha.mix(cosine.mix(low[cosine.index], low[cosine.index + 1]),
                     cosine.mix(high[cosine.index], high[cosine.index + 1]));
  }
};

const InterfaceAlbedo::Slice& InterfaceAlbedo::slice(int index) {
  static std::array<std::once_flag, kIndices> made;
  static std::array<std::unique_ptr<const Slice>, kIndices> slices;
  std::call_once(made[index], [&] { slices[index] = std::make_unique<const Slice>(index_at(index)); });
  return *slices[index];
}

InterfaceAlbedo::InterfaceAlbedo(float alpha, float n)
    : below_(slice(table_position(index_axis(n), kIndices).index)),
      above_(slice(table_position(index_axis(n), kIndices).index + 1)),
      alpha_(table_position(std::sqrt(alpha), kAlphas)),
      fraction_(table_position(index_axis(n), kIndices).fraction) {}

float InterfaceAlbedo::at(float cosine) const {
  const TablePosition column = table_position(std::sqrt(cosine), kCosines);
  const float below = below_.at(alpha_, column);
  return below + fraction_ * (above_.at(alpha_, column) - below);
}

float InterfaceAlbedo::mean() const {
  const auto of = [&](const Slice& slice) {
    return alpha_.mix(slice.mean[alpha_.index], slice.mean[alpha_.index + 1]);
  };
  return of(below_) + fraction_ * (of(above_) - of(below_));
}

float mean_fresnel_transmittance(float n) {
  if (n < 1.0f) return n * n * mean_fresnel_transmittance(1.0f / n);  // radiance over n^2 is kept
  const double m = std::max<double>(n, 1.0 + 1e-5);                   // the terms cancel near 1
  const double m2 = m * m, m4 = m2 * m2, above = m2 - 1.0, sum = m2 + 1.0;
  const double reflected = 0.5 + (m - 1.0) * (3.0 * m + 1.0) / (6.0 * (m + 1.0) * (m + 1.0)) +
                           m2 * above * above / (sum * sum * sum) * std::log((m - 1.0) / (m + 1.0)) -
                           2.0 * m * m2 * (m2 + 2.0 * m - 1.0) / (sum * (m4 - 1.0)) +
                           8.0 * m4 * (m4 + 1.0) / (sum * (m4 - 1.0) * (m4 - 1.0)) * std::log(m);
  return static_cast<float>(std::clamp(1.0 - reflected, 0.0, 1.0));
}

}  // namespace becalm::tracer
