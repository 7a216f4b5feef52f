#include "tracer/materials/principled_tables.h"

#include <memory>
#include <numbers>

#include "tracer/materials/local_direction.h"
#include "tracer/materials/microfacet.h"

namespace becalm::tracer {

namespace {

constexpr Lattice kLattice{.points = 610, .before = 377};

float fifth_power(float v) {
  const float v2 = v * v;
  return v2 * v2 * v;
}

/// Along the tangent, or across it.
V3f direction_at(float cosine, bool across = false) {
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  return across ? V3f(0.0f, sine, cosine) : V3f(sine, 0.0f, cosine);
}

GgxAlbedo integrate_ggx(const V3f& wo, const GgxAlpha& alpha) {
  double f0 = 0.0, f90 = 0.0;
  for (int i = 0; i < kLattice.points; ++i) {
    const V3f m = ggx_sample_visible_normal(wo, alpha, kLattice.point(i));
    const V3f wi = reflect(wo, m);
    if (wi.z <= 0.0f) continue;
    const double weight = mirrored_weight(wo, wi, alpha);
    const double schlick = fifth_power(1.0f - std::clamp(wo.dot(m), 0.0f, 1.0f));
    f0 += weight * (1.0 - schlick);
    f90 += weight * schlick;
  }
  return {static_cast<float>(f0 / kLattice.points), static_cast<float>(f90 / kLattice.points)};
}

GgxAlbedo integrate_ggx(float cosine, float alpha, float aspect) {
  if (alpha == 0.0f) {
    const float schlick = fifth_power(1.0f - cosine);
    return {1.0f - schlick, schlick};
  }
  cosine = std::max(cosine, 1e-5f);  // the limit at the horizon is approached, not reached
  const GgxAlpha widths(alpha / aspect, alpha * aspect);
  const auto with_margin = [](float whole, float f90) {
    const float more = std::min(1.0f, whole + kAlbedoMargin), more_f90 = std::min(more, f90 + kAlbedoMargin);
    return GgxAlbedo{more - more_f90, more_f90};
  };
  const GgxAlbedo along = integrate_ggx(direction_at(cosine), widths);
  if (aspect == 1.0f) return with_margin(along.f0 + along.f90, along.f90);
  // The largest of the whole and of the grazing part, which bounds f0 F0 + f90 F90 for every F90 >= F0.
  const GgxAlbedo across = integrate_ggx(direction_at(cosine, true), widths);
  const float f90 = std::max(along.f90, across.f90);
  return with_margin(std::max(along.f0 + along.f90, across.f0 + across.f90), f90);
}

float integrate_sheen(float cosine) {
  const V3f wo = direction_at(cosine);
  double sum = 0.0;
  for (int i = 0; i < kLattice.points; ++i) {
    const V2f u = kLattice.point(i);
    const float radius = std::sqrt(u.y), phi = 2.0f * std::numbers::pi_v<float> * u.x;
    const V3f wi(radius * std::cos(phi), radius * std::sin(phi), std::sqrt(1.0f - u.y));
    sum += fifth_power(1.0f - std::clamp(wo.dot((wo + wi).normalized()), 0.0f, 1.0f));
  }
  return static_cast<float>(std::numbers::pi * sum / kLattice.points) + kAlbedoMargin;
}

}  // namespace

const PrincipledTables& PrincipledTables::get() {
  static const PrincipledTables tables;
  return tables;
}

const PrincipledTables::Slices& PrincipledTables::anisotropic() {
  static const std::unique_ptr<const Slices> slices = [] {
    auto made = std::make_unique<Slices>();
    for (int i = 0; i < kAspects - 1; ++i) {
      (*made)[i].integrate(kLeastAspect + (1.0f - kLeastAspect) * static_cast<float>(i) / (kAspects - 1));
    }
    return made;
  }();
  return *slices;
}

PrincipledTables::PrincipledTables() {
  isotropic_.integrate(1.0f);
  for (int j = 0; j < kCosines; ++j) sheen_[j] = integrate_sheen(squared_node(j, kCosines));
}

void PrincipledTables::Slice::integrate(float aspect) {
  const auto weights = cosine_weights<kCosines>();
  for (int i = 0; i < kAlphas; ++i) {
    for (int j = 0; j < kCosines; ++j) {
      albedo[i][j] = integrate_ggx(squared_node(j, kCosines), squared_node(i, kAlphas), aspect);
    }
    double f0 = 0.0, f90 = 0.0;
    for (int j = 0; j < kCosines; ++j) {
      f0 += weights[j] * albedo[i][j].f0;
      f90 += weights[j] * albedo[i][j].f90;
    }
    mean[i] = {static_cast<float>(f0), static_cast<float>(f90)};
  }
}

}  // namespace becalm::tracer
