#include "tracer/materials/bsdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tracer/materials/fresnel.h"
#include "tracer/materials/interface_albedo.h"
#include "tracer/materials/local_direction.h"
#include "tracer/materials/microfacet.h"
#include "tracer/materials/multiple_scattering.h"
#include "tracer/materials/principled.h"
#include "tracer/materials/principled_albedo.h"

// Each model overloads evaluate_model, sample_model, is_specular_model and albedo_model; the visitors below
// have no default, so that one left out fails to compile.
#include "tracer/materials/diffuse.inl"
// After the one above, which is a part of these.
#include "tracer/materials/conductor.inl"
#include "tracer/materials/dielectric.inl"
// After all of them.
#include "tracer/materials/principled.inl"

namespace becalm::tracer {

BsdfValue evaluate(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  return std::visit([&](const auto& model) { return evaluate_model(model, wo, wi); }, bsdf);
}

std::optional<BsdfSample> sample(const Bsdf& bsdf, const V3f& wo, const V2f& u, float u_lobe) {
  return std::visit([&](const auto& model) { return sample_model(model, wo, u, u_lobe); }, bsdf);
}

bool is_specular(const Bsdf& bsdf) {
  return std::visit([](const auto& model) { return is_specular_model(model); }, bsdf);
}

namespace {

bool transmits_model(const DiffuseBsdf&) {
  return false;
}
bool transmits_model(const ConductorBsdf&) {
  return false;
}
bool transmits_model(const DielectricBsdf&) {
  return true;
}
bool transmits_model(const PrincipledBsdf& bsdf) {
  return bsdf.glass > 0.0f;
}

}  // namespace

bool transmits(const Bsdf& bsdf) {
  return std::visit([](const auto& model) { return transmits_model(model); }, bsdf);
}

V3f albedo(const Bsdf& bsdf) {
  const V3f value = std::visit([](const auto& model) { return albedo_model(model); }, bsdf);
  return {std::clamp(value.x, 0.0f, 1.0f), std::clamp(value.y, 0.0f, 1.0f), std::clamp(value.z, 0.0f, 1.0f)};
}

namespace {

void widen_alpha(float& alpha, float slope_variance) {
  alpha = std::min(1.0f, std::sqrt(alpha * alpha + slope_variance));
}
void widen_model(DiffuseBsdf&, float) {}
void widen_model(ConductorBsdf& bsdf, float slope_variance) {
  widen_alpha(bsdf.alpha, slope_variance);
  bsdf = ConductorBsdf(bsdf.eta, bsdf.k, bsdf.alpha);
}
void widen_model(DielectricBsdf& bsdf, float slope_variance) {
  widen_alpha(bsdf.alpha, slope_variance);
  bsdf = DielectricBsdf(bsdf.eta, bsdf.alpha, bsdf.transmittance);
}
void widen_model(PrincipledBsdf& bsdf, float slope_variance) {
  widen_alpha(bsdf.alpha, slope_variance);
  bsdf.alpha = std::min(bsdf.alpha, bsdf.aspect);  // so that neither width exceeds 1
  scale_to_lobe(bsdf);
  widen_alpha(bsdf.coat_alpha, slope_variance);
}

}  // namespace

void widen(Bsdf& bsdf, float slope_variance) {
  std::visit([&](auto& model) { widen_model(model, slope_variance); }, bsdf);
}

float roughness_to_alpha(float roughness) {
  const float clamped = std::clamp(roughness, 0.0f, 1.0f);
  return clamped * clamped;
}

}  // namespace becalm::tracer
