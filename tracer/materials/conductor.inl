// Metals: GGX microfacets of perfect mirrors, one scattering, visible-normal sampling. Included by bsdf.cpp
// alone.

namespace becalm::tracer {
namespace {

V3f fresnel(const ConductorBsdf& bsdf, float cos_o) {
  return {fresnel_conductor(cos_o, bsdf.eta.x, bsdf.k.x), fresnel_conductor(cos_o, bsdf.eta.y, bsdf.k.y),
          fresnel_conductor(cos_o, bsdf.eta.z, bsdf.k.z)};
}

bool is_specular_model(const ConductorBsdf& bsdf) {
  return bsdf.alpha < kSmoothAlpha;
}

V3f eval_model(const ConductorBsdf& bsdf, const V3f& wo, const V3f& wi) {
  if (!same_side(wo, wi) || is_specular_model(bsdf)) return V3f(0.0f);
  const V3f o = upper(wo);
  const V3f i = upper(wi);
  const V3f m = (o + i).normalized();
  return fresnel(bsdf, std::clamp(o.dot(m), 0.0f, 1.0f)) * mirrored(o, i, m, bsdf.alpha);
}

float pdf_model(const ConductorBsdf& bsdf, const V3f& wo, const V3f& wi) {
  if (!same_side(wo, wi) || is_specular_model(bsdf)) return 0.0f;
  const V3f o = upper(wo);
  return pdf_mirrored_normal(o, (o + upper(wi)).normalized(), bsdf.alpha);
}

std::optional<BsdfSample> sample_model(const ConductorBsdf& bsdf, const V3f& wo, const V2f& u, float) {
  if (wo.z == 0.0f) return std::nullopt;
  const V3f o = upper(wo);
  if (is_specular_model(bsdf)) {
    return BsdfSample{.wi = V3f(-wo.x, -wo.y, wo.z),
                      .weight = fresnel(bsdf, std::min(o.z, 1.0f)),
                      .pdf = 0.0f,
                      .specular = true,
                      .transmitted = false,
                      .radiance_scale = 1.0f};
  }
  const V3f m = ggx_sample_visible_normal(o, bsdf.alpha, u);
  const V3f i = reflect(o, m).normalized();
  if (i.z <= 0.0f) return std::nullopt;
  return BsdfSample{
      .wi = V3f(i.x, i.y, std::copysign(i.z, wo.z)),
      .weight = fresnel(bsdf, std::clamp(o.dot(m), 0.0f, 1.0f)) * mirrored_weight(o, i, bsdf.alpha),
      .pdf = pdf_mirrored_normal(o, m, bsdf.alpha),
      .specular = false,
      .transmitted = false,
      .radiance_scale = 1.0f};
}

V3f albedo_model(const ConductorBsdf& bsdf) {
  return fresnel(bsdf, 1.0f);
}

}  // namespace
}  // namespace becalm::tracer
