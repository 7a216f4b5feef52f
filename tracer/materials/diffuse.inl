// Lambertian reflection f = reflectance / pi, sampled by the cosine. Included by bsdf.cpp alone.

namespace becalm::tracer {
namespace {

BsdfValue evaluate_model(const DiffuseBsdf& bsdf, const V3f& wo, const V3f& wi) {
  if (!same_side(wo, wi)) return {V3f(0.0f), 0.0f};
  const float cos_pi = std::abs(wi.z) * std::numbers::inv_pi_v<float>;
  return {bsdf.reflectance * cos_pi, cos_pi};
}

std::optional<BsdfSample> sample_model(const DiffuseBsdf& bsdf, const V3f& wo, const V2f& u, float) {
  // Uniform disc projected up; u.x is the squared radius, so that cos = sqrt(1 - u.x) loses no precision.
  const float radius = std::sqrt(u.x);
  const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
  const float cos_i = std::sqrt(std::max(0.0f, 1.0f - u.x));
  if (cos_i == 0.0f || wo.z == 0.0f) return std::nullopt;
  const V3f wi(radius * std::cos(phi), radius * std::sin(phi), std::copysign(cos_i, wo.z));
  return BsdfSample{.wi = wi,
                    .weight = bsdf.reflectance,
                    .pdf_solid_angle = cos_i * std::numbers::inv_pi_v<float>,
                    .specular = false,
                    .transmitted = false,
                    .radiance_scale = 1.0f};
}

bool is_specular_model(const DiffuseBsdf&) {
  return false;
}

V3f albedo_model(const DiffuseBsdf& bsdf) {
  return bsdf.reflectance;
}

}  // namespace
}  // namespace becalm::tracer
