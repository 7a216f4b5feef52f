// Clear interfaces: GGX microfacets that reflect and refract (Walter et al., "Microfacet Models for
// Refraction through Rough Surfaces", 2007). Included by bsdf.cpp alone.
//
// A microfacet m is drawn from the normals visible from wo, then one of its two lobes in proportion to what
// it passes: R to reflection, (1 - R) * the strongest channel of the transmittance to refraction. With n =
// n_wi / n_wo, what is refracted is (Walter's eq. 21 with the roles of radiance transport)
//   f |cos wi| = T (1 - R) D G |wo.m| |wi.m| / (|cos wo| (n wi.m + wo.m)^2),
// and the Jacobian of m to wi is n^2 |wi.m| / (n wi.m + wo.m)^2 (eq. 17), so that f |cos| / pdf = T (1 - R) /
// P(refract) G / G1(wo) / n^2: the last factor is the compression of radiance. Reflection uses the
// height-correlated G, refraction the product of G1's, as Walter does.

namespace becalm::tracer {
namespace {

/// Wide enough for 32-bit directions: refraction turns by |eta - 1| of what the microfacets turn.
bool is_rough(const DielectricBsdf& bsdf) {
  return bsdf.alpha * std::min(1.0f, std::abs(bsdf.eta - 1.0f)) >= kSmoothAlpha;
}

bool is_specular_model(const DielectricBsdf& bsdf) {
  return !is_rough(bsdf);
}

/// Index of refraction across the interface over that on the side of wo.
float eta_ratio(const DielectricBsdf& bsdf, const V3f& wo) {
  return wo.z > 0.0f ? bsdf.eta : 1.0f / bsdf.eta;
}

/// What one (micro)facet does with light, and how often each lobe is drawn.
struct Split {
  float reflected;
  V3f transmitted;
  float p_reflect;  ///< 0 to 1; both are 0 when the facet passes nothing
  float p_transmit;
  float cos_t;  ///< cosine across the facet
};

Split split(const DielectricBsdf& bsdf, float cos_o, float n) {
  Split s;
  s.reflected = fresnel_dielectric(std::clamp(cos_o, 0.0f, 1.0f), n, &s.cos_t);
  s.transmitted = bsdf.transmittance * (1.0f - s.reflected);
  const float strongest = std::max({s.transmitted.x, s.transmitted.y, s.transmitted.z, 0.0f});
  const float sum = s.reflected + strongest;
  s.p_reflect = sum > 0.0f ? s.reflected / sum : 0.0f;
  s.p_transmit = sum > 0.0f ? strongest / sum : 0.0f;
  return s;
}

/// The microfacet that turns wo (above) into wi, m.z > 0; nothing where no visible one does.
std::optional<V3f> facet_between(const V3f& wo, const V3f& wi, float n) {
  V3f m = wi.z > 0.0f ? wo + wi : wo + wi * n;
  const float length = m.length();
  if (wo.z == 0.0f || wi.z == 0.0f || length == 0.0f) return std::nullopt;
  m /= std::copysign(length, m.z);  // the inverse of a tiny length would be infinite
  if (wo.dot(m) <= 0.0f || wi.dot(m) * wi.z <= 0.0f) return std::nullopt;
  return m;
}

/// wo and wi turned so that wo lies above.
struct Turned {
  V3f wo;
  V3f wi;
};
Turned turned(const V3f& wo, const V3f& wi) {
  return {upper(wo), V3f(wi.x, wi.y, std::copysign(1.0f, wo.z) * wi.z)};
}

float square(float v) {
  return v * v;
}

V3f eval_model(const DielectricBsdf& bsdf, const V3f& wo_any, const V3f& wi_any) {
  if (!is_rough(bsdf)) return V3f(0.0f);
  const auto [wo, wi] = turned(wo_any, wi_any);
  const float n = eta_ratio(bsdf, wo_any);
  const std::optional<V3f> m = facet_between(wo, wi, n);
  if (!m) return V3f(0.0f);
  const Split s = split(bsdf, wo.dot(*m), n);
  if (wi.z > 0.0f) return V3f(s.reflected * mirrored(wo, wi, *m, bsdf.alpha));
  const float wo_m = wo.dot(*m);
  const float wi_m = wi.dot(*m);
  const float g = ggx_g1_over_cos(wo, bsdf.alpha) * ggx_g1_over_cos(upper(wi), bsdf.alpha) * -wi.z;
  return s.transmitted * (ggx_d(*m, bsdf.alpha) * g * std::abs(wo_m * wi_m) / square(n * wi_m + wo_m));
}

float pdf_refracted_normal(const V3f& wo, const V3f& wi, const V3f& m, float n, float alpha) {
  const float wi_m = wi.dot(m);
  return ggx_pdf_visible_normal(wo, m, alpha) * square(n) * std::abs(wi_m) / square(n * wi_m + wo.dot(m));
}

float pdf_model(const DielectricBsdf& bsdf, const V3f& wo_any, const V3f& wi_any) {
  if (!is_rough(bsdf)) return 0.0f;
  const auto [wo, wi] = turned(wo_any, wi_any);
  const float n = eta_ratio(bsdf, wo_any);
  const std::optional<V3f> m = facet_between(wo, wi, n);
  if (!m) return 0.0f;
  const Split s = split(bsdf, wo.dot(*m), n);
  if (wi.z > 0.0f) return s.p_reflect * pdf_mirrored_normal(wo, *m, bsdf.alpha);
  return s.p_transmit * pdf_refracted_normal(wo, wi, *m, n, bsdf.alpha);
}

std::optional<BsdfSample> sample_model(const DielectricBsdf& bsdf, const V3f& wo_any, const V2f& u,
                                       float u_lobe) {
  if (wo_any.z == 0.0f) return std::nullopt;
  const V3f wo = upper(wo_any);
  const bool rough = is_rough(bsdf);
  const V3f m = rough ? ggx_sample_visible_normal(wo, bsdf.alpha, u) : V3f(0.0f, 0.0f, 1.0f);
  const float cos_o = wo.dot(m);
  if (cos_o <= 0.0f) return std::nullopt;
  const float n = eta_ratio(bsdf, wo_any);
  const Split s = split(bsdf, cos_o, n);

  if (u_lobe < s.p_reflect) {
    const V3f wi = rough ? reflect(wo, m).normalized() : V3f(-wo.x, -wo.y, wo.z);
    if (wi.z <= 0.0f) return std::nullopt;
    const float masking = rough ? mirrored_weight(wo, wi, bsdf.alpha) : 1.0f;
    return BsdfSample{.wi = V3f(wi.x, wi.y, std::copysign(wi.z, wo_any.z)),
                      .weight = V3f(s.reflected / s.p_reflect * masking),
                      .pdf = rough ? s.p_reflect * pdf_mirrored_normal(wo, m, bsdf.alpha) : 0.0f,
                      .specular = !rough,
                      .transmitted = false,
                      .radiance_scale = 1.0f};
  }
  if (s.p_transmit == 0.0f) return std::nullopt;

  const V3f wi = (m * (cos_o / n - s.cos_t) - wo / n).normalized();
  if (wi.z >= 0.0f) return std::nullopt;
  const float radiance_scale = 1.0f / square(n);
  const float masking = rough ? -wi.z * ggx_g1_over_cos(upper(wi), bsdf.alpha) : 1.0f;
  return BsdfSample{.wi = V3f(wi.x, wi.y, std::copysign(wi.z, -wo_any.z)),
                    .weight = s.transmitted * (masking * radiance_scale / s.p_transmit),
                    .pdf = rough ? s.p_transmit * pdf_refracted_normal(wo, wi, m, n, bsdf.alpha) : 0.0f,
                    .specular = !rough,
                    .transmitted = true,
                    .radiance_scale = radiance_scale};
}

V3f albedo_model(const DielectricBsdf& bsdf) {
  const Split s = split(bsdf, 1.0f, bsdf.eta);
  return s.transmitted + V3f(s.reflected);
}

}  // namespace
}  // namespace becalm::tracer
