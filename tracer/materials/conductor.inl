// Metals: GGX microfacets of perfect mirrors, visible-normal sampling, and a cosine lobe for what leaves the
// microsurface after further bounces. Included by bsdf.cpp alone.

namespace becalm::tracer {
namespace {

V3f fresnel(const V3f& eta, const V3f& k, float cos_o) {
  return {fresnel_conductor(cos_o, eta.x, k.x), fresnel_conductor(cos_o, eta.y, k.y),
          fresnel_conductor(cos_o, eta.z, k.z)};
}

bool is_specular_model(const ConductorBsdf& bsdf) {
  return bsdf.alpha < kSmoothAlpha;
}

/// Share of uniform light that one scattering loses, at a cosine.
float lost(const ConductorBsdf& bsdf, float cosine) {
  const GgxAlbedo once = PrincipledTables::get().albedo(std::min(1.0f, cosine), {bsdf.alpha, 1.0f});
  return std::max(0.0f, 1.0f - once.f0 - once.f90);
}

/// With which the lobe of further bounces is sampled, where `lost` is that of wo.
float further_probability(const ConductorBsdf& bsdf, float lost) {
  const float further = bsdf.further_albedo * lost;
  const float once = max_component(bsdf.facing) * (1.0f - lost);
  return further > 0.0f ? further / (further + once) : 0.0f;
}

/// Of a rough conductor, for directions above the surface.
BsdfValue evaluate_upper(const ConductorBsdf& bsdf, float lost_o, const V3f& o, const V3f& i) {
  const V3f m = (o + i).normalized();
  const float p = further_probability(bsdf, lost_o);
  const float cos_pi = i.z * std::numbers::inv_pi_v<float>;
  return {fresnel(bsdf.eta, bsdf.k, std::clamp(o.dot(m), 0.0f, 1.0f)) * mirrored(o, i, m, bsdf.alpha) +
              bsdf.further_gain * (lost_o * lost(bsdf, i.z) * cos_pi),
          (1.0f - p) * pdf_mirrored_normal(o, m, bsdf.alpha) + p * cos_pi};
}

BsdfValue evaluate_model(const ConductorBsdf& bsdf, const V3f& wo, const V3f& wi) {
  if (!same_side(wo, wi) || is_specular_model(bsdf)) return {V3f(0.0f), 0.0f};
  const V3f o = upper(wo);
  return evaluate_upper(bsdf, lost(bsdf, o.z), o, upper(wi));
}

std::optional<BsdfSample> sample_model(const ConductorBsdf& bsdf, const V3f& wo, const V2f& u, float u_lobe) {
  if (wo.z == 0.0f) return std::nullopt;
  const V3f o = upper(wo);
  if (is_specular_model(bsdf)) {
    return BsdfSample{.wi = V3f(-wo.x, -wo.y, wo.z),
                      .weight = fresnel(bsdf.eta, bsdf.k, std::min(o.z, 1.0f)),
                      .pdf_solid_angle = 0.0f,
                      .specular = true,
                      .transmitted = false,
                      .radiance_scale = 1.0f};
  }
  const float lost_o = lost(bsdf, o.z);
  V3f i;
  if (u_lobe < further_probability(bsdf, lost_o)) {
    const std::optional<BsdfSample> cosine = sample_model(DiffuseBsdf{V3f(1.0f)}, o, u, 0.0f);
    if (!cosine) return std::nullopt;
    i = cosine->wi;
  } else {
    i = reflect(o, ggx_sample_visible_normal(o, bsdf.alpha, u)).normalized();
  }
  if (i.z <= 0.0f) return std::nullopt;
  const BsdfValue value = evaluate_upper(bsdf, lost_o, o, i);
  if (!(value.pdf_solid_angle > 0.0f) || !std::isfinite(value.pdf_solid_angle)) return std::nullopt;
  return BsdfSample{.wi = V3f(i.x, i.y, std::copysign(i.z, wo.z)),
                    .weight = value.f_cos / value.pdf_solid_angle,
                    .pdf_solid_angle = value.pdf_solid_angle,
                    .specular = false,
                    .transmitted = false,
                    .radiance_scale = 1.0f};
}

V3f albedo_model(const ConductorBsdf& bsdf) {
  return bsdf.facing;
}

}  // namespace

ConductorBsdf::ConductorBsdf(const V3f& eta_in, const V3f& k_in, float width)
    : eta(eta_in), k(k_in), alpha(width), facing(fresnel(eta_in, k_in, 1.0f)) {
  if (is_specular_model(*this)) return;
  const GgxAlbedo parts = PrincipledTables::get().mean_albedo({alpha, 1.0f});
  const float mean = std::min(1.0f, parts.f0 + parts.f90);
  for (int c = 0; c < 3; ++c)
    further_gain[c] = multiple_scattering_gain(mean) * multiple_scattering_color(facing[c], 1.0f, mean);
  further_albedo = max_component(further_gain) * (1.0f - mean);
}

}  // namespace becalm::tracer
