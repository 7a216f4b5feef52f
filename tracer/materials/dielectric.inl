// Clear interfaces: GGX microfacets that reflect and refract (Walter et al., "Microfacet Models for
// Refraction through Rough Surfaces", 2007), and cosine lobes for what leaves the microsurface after further
// bounces. Included by bsdf.cpp alone.
//
// A microfacet m is drawn from the normals visible from wo, then one of its two lobes in proportion to what
// it passes: R to reflection, (1 - R) * the strongest channel of the transmittance to refraction. With n =
// n_wi / n_wo, what is refracted is (Walter's eq. 21 with the roles of radiance transport)
//   f |cos wi| = T (1 - R) D G |wo.m| |wi.m| / (|cos wo| (n wi.m + wo.m)^2),
// and the Jacobian of m to wi is n^2 |wi.m| / (n wi.m + wo.m)^2 (eq. 17), so that f |cos| / pdf = T (1 - R) /
// P(refract) G / G1(wo) / n^2: the last factor is the compression of radiance. Reflection uses the
// height-correlated G, refraction the product of G1's, as Walter does.
//
// What one scattering loses, l_o(wo) = 1 - E_o(wo) seen from the side of wo, leaves on both sides (Kulla and
// Conty 2017): with the mean losses L_o and L_t here and across, and the mean share C_o that Fresnel's
// reflectance lets through from here,
//   reflected  f |cos wi| = r_o l_o(wo) l_o(wi) |cos wi| / (pi L_o),        r_o = 1 - C_o min(L_o, L_t) / L_o
//   refracted  f |cos wi| = T C_o l_o(wo) l_t(wi) |cos wi| / (pi max(L_o, L_t)) / n^2.
// Both add up to l_o(wo), and since C_o = n^2 C_t the pair is reciprocal as Walter's lobes are.

namespace becalm::tracer {
namespace {

/// Wide enough for 32-bit directions: refraction turns by |eta - 1| of what the microfacets turn.
bool is_rough(float alpha, float eta) {
  return alpha * std::min(1.0f, std::abs(eta - 1.0f)) >= kSmoothAlpha;
}
bool is_rough(const DielectricBsdf& bsdf) {
  return is_rough(bsdf.alpha, bsdf.eta);
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

float square(float v) {
  return v * v;
}

/// The lobes of further bounces at a rough interface, for light that leaves to a direction wo above it.
class FurtherBounces {
 public:
  FurtherBounces(const DielectricBsdf& bsdf, const V3f& wo, float n, bool outside)
      : bsdf_(bsdf),
        n_(n),
        here_(outside ? bsdf.lost_outside : bsdf.lost_inside),
        across_(outside ? bsdf.lost_inside : bsdf.lost_outside),
        crossing_(outside ? bsdf.crossing : bsdf.crossing / square(bsdf.eta)),
        lost_(lost(n, wo.z)) {
    const float strongest = std::max(0.0f, max_component(bsdf.transmittance));
    const float crosses = crossing_ * std::min(here_, across_) / here_;
    reflected_ = 1.0f - crosses;
    p_reflect_ = reflected_ / (reflected_ + crosses * strongest);
    const float further = lost_ * (reflected_ + crosses * strongest);
    const float fresnel = fresnel_dielectric(std::min(1.0f, wo.z), n);
    const float once = (1.0f - lost_) * (fresnel + (1.0f - fresnel) * strongest);
    // One scattering must still be drawn where it carries little: its lobes are narrower.
    constexpr float most = 0.75f;
    probability_ = std::min(most, further / (further + once));
  }

  /// With which they are drawn instead of the lobes of one scattering.
  float probability() const { return probability_; }
  /// With which they are then drawn on the side of wo.
  float p_reflect() const { return p_reflect_; }

  /// With the density of the lobes alone.
  BsdfValue evaluate(const V3f& wi) const {
    const float cos_pi = std::abs(wi.z) * std::numbers::inv_pi_v<float>;
    if (wi.z > 0.0f) return {V3f(reflected_ * lost_ * lost(n_, wi.z) * cos_pi / here_), p_reflect_ * cos_pi};
    const float energy = crossing_ * lost_ * lost(1.0f / n_, -wi.z) * cos_pi / std::max(here_, across_);
    return {bsdf_.transmittance * (energy / square(n_)), (1.0f - p_reflect_) * cos_pi};
  }

 private:
  /// Share of uniform light that one scattering loses, at a cosine of the side that sees the index n. Never
  /// 0: what is drawn has a value.
  float lost(float n, float cosine) const {
    constexpr float least = 1e-4f;
    return std::max(least, 1.0f - InterfaceAlbedo(bsdf_.alpha, n).at(std::min(1.0f, cosine)));
  }

  const DielectricBsdf& bsdf_;
  float n_;
  float here_, across_, crossing_;
  float lost_;
  float reflected_;
  float p_reflect_;
  float probability_;
};

/// The microfacet that turns wo (above) into wi, m.z > 0; nothing where no visible one does.
std::optional<V3f> facet_between(const V3f& wo, const V3f& wi, float n) {
  V3f m = wi.z > 0.0f ? wo + wi : wo + wi * n;
  const float length = m.length();
  if (wo.z == 0.0f || wi.z == 0.0f || length == 0.0f) return std::nullopt;
  m /= std::copysign(length, m.z);  // the inverse of a tiny length would be infinite
  if (wo.dot(m) <= 0.0f || wi.dot(m) * wi.z <= 0.0f) return std::nullopt;
  return m;
}

float pdf_refracted_normal(const V3f& wo, const V3f& wi, const V3f& m, float n, float alpha) {
  const float wi_m = wi.dot(m);
  return ggx_pdf_visible_normal(wo, m, alpha) * square(n) * std::abs(wi_m) / square(n * wi_m + wo.dot(m));
}

/// One scattering at a rough interface.
BsdfValue evaluate_once(const DielectricBsdf& bsdf, const V3f& wo, const V3f& wi, float n) {
  const std::optional<V3f> m = facet_between(wo, wi, n);
  if (!m) return {V3f(0.0f), 0.0f};
  const Split s = split(bsdf, wo.dot(*m), n);
  if (wi.z > 0.0f) {
    return {V3f(s.reflected * mirrored(wo, wi, *m, bsdf.alpha)),
            s.p_reflect * pdf_mirrored_normal(wo, *m, bsdf.alpha)};
  }
  const float wo_m = wo.dot(*m), wi_m = wi.dot(*m);
  const float g = ggx_g1_over_cos(wo, bsdf.alpha) * ggx_g1_over_cos(upper(wi), bsdf.alpha) * -wi.z;
  return {s.transmitted * (ggx_d(*m, bsdf.alpha) * g * std::abs(wo_m * wi_m) / square(n * wi_m + wo_m)),
          s.p_transmit * pdf_refracted_normal(wo, wi, *m, n, bsdf.alpha)};
}

/// Both together.
BsdfValue add(const FurtherBounces& further, const BsdfValue& once, const V3f& wi) {
  const BsdfValue more = further.evaluate(wi);
  const float p = further.probability();
  return {once.f_cos + more.f_cos, (1.0f - p) * once.pdf_solid_angle + p * more.pdf_solid_angle};
}

BsdfValue evaluate_model(const DielectricBsdf& bsdf, const V3f& wo_any, const V3f& wi_any) {
  if (!is_rough(bsdf) || wo_any.z == 0.0f || wi_any.z == 0.0f) return {V3f(0.0f), 0.0f};
  const float n = eta_ratio(bsdf, wo_any);
  const V3f wo = upper(wo_any), wi(wi_any.x, wi_any.y, std::copysign(1.0f, wo_any.z) * wi_any.z);
  return add(FurtherBounces(bsdf, wo, n, wo_any.z > 0.0f), evaluate_once(bsdf, wo, wi, n), wi);
}

/// One scattering, for wo above; of a smooth interface the delta lobes.
std::optional<BsdfSample> sample_once(const DielectricBsdf& bsdf, const V3f& wo, float n, const V2f& u,
                                      float u_lobe) {
  const bool rough = is_rough(bsdf);
  const V3f m = rough ? ggx_sample_visible_normal(wo, bsdf.alpha, u) : V3f(0.0f, 0.0f, 1.0f);
  const float cos_o = wo.dot(m);
  if (cos_o <= 0.0f) return std::nullopt;
  const Split s = split(bsdf, cos_o, n);

  if (u_lobe < s.p_reflect) {
    const V3f wi = rough ? reflect(wo, m).normalized() : V3f(-wo.x, -wo.y, wo.z);
    if (wi.z <= 0.0f) return std::nullopt;
    const float masking = rough ? mirrored_weight(wo, wi, bsdf.alpha) : 1.0f;
    return BsdfSample{.wi = wi,
                      .weight = V3f(s.reflected / s.p_reflect * masking),
                      .pdf_solid_angle = rough ? s.p_reflect * pdf_mirrored_normal(wo, m, bsdf.alpha) : 0.0f,
                      .specular = !rough,
                      .transmitted = false,
                      .radiance_scale = 1.0f};
  }
  if (s.p_transmit == 0.0f) return std::nullopt;

  const V3f wi = (m * (cos_o / n - s.cos_t) - wo / n).normalized();
  if (wi.z >= 0.0f) return std::nullopt;
  const float radiance_scale = 1.0f / square(n);
  const float masking = rough ? -wi.z * ggx_g1_over_cos(upper(wi), bsdf.alpha) : 1.0f;
  return BsdfSample{
      .wi = wi,
      .weight = s.transmitted * (masking * radiance_scale / s.p_transmit),
      .pdf_solid_angle = rough ? s.p_transmit * pdf_refracted_normal(wo, wi, m, n, bsdf.alpha) : 0.0f,
      .specular = !rough,
      .transmitted = true,
      .radiance_scale = radiance_scale};
}

/// Of a rough interface, for wo above.
std::optional<BsdfSample> sample_rough(const DielectricBsdf& bsdf, const FurtherBounces& further,
                                       const V3f& wo, float n, const V2f& u, float u_lobe) {
  const float p = further.probability();
  BsdfSample drawn;
  BsdfValue once;
  if (u_lobe < p) {
    const bool reflects = u_lobe < p * further.p_reflect();
    const std::optional<BsdfSample> cosine =
        sample_model(DiffuseBsdf{V3f(1.0f)}, reflects ? wo : -wo, u, 0.0f);
    if (!cosine) return std::nullopt;
    drawn = *cosine;
    drawn.transmitted = !reflects;
    drawn.radiance_scale = reflects ? 1.0f : 1.0f / square(n);
    once = evaluate_once(bsdf, wo, drawn.wi, n);
  } else {
    const float u_once = std::min((u_lobe - p) / (1.0f - p), 0x1.fffffep-1f);
    const std::optional<BsdfSample> found = sample_once(bsdf, wo, n, u, u_once);
    if (!found || !(found->pdf_solid_angle > 0.0f) || !std::isfinite(found->pdf_solid_angle))
      return std::nullopt;
    drawn = *found;
    once = {found->weight * found->pdf_solid_angle, found->pdf_solid_angle};
  }
  const BsdfValue value = add(further, once, drawn.wi);
  if (!(value.pdf_solid_angle > 0.0f) || !std::isfinite(value.pdf_solid_angle)) return std::nullopt;
  drawn.weight = value.f_cos / value.pdf_solid_angle;
  drawn.pdf_solid_angle = value.pdf_solid_angle;
  return drawn;
}

std::optional<BsdfSample> sample_model(const DielectricBsdf& bsdf, const V3f& wo_any, const V2f& u,
                                       float u_lobe) {
  if (wo_any.z == 0.0f) return std::nullopt;
  const V3f wo = upper(wo_any);
  const float n = eta_ratio(bsdf, wo_any);
  std::optional<BsdfSample> drawn =
      is_rough(bsdf) ? sample_rough(bsdf, FurtherBounces(bsdf, wo, n, wo_any.z > 0.0f), wo, n, u, u_lobe)
                     : sample_once(bsdf, wo, n, u, u_lobe);
  if (drawn) drawn->wi.z *= std::copysign(1.0f, wo_any.z);
  return drawn;
}

V3f albedo_model(const DielectricBsdf& bsdf) {
  const Split s = split(bsdf, 1.0f, bsdf.eta);
  return s.transmitted + V3f(s.reflected);
}

}  // namespace

DielectricBsdf::DielectricBsdf(float index, float width, const V3f& tint)
    : eta(index), alpha(width), transmittance(tint) {
  if (!is_rough(*this)) return;
  lost_outside = multiple_scattering_loss(InterfaceAlbedo(alpha, eta).mean());
  lost_inside = multiple_scattering_loss(InterfaceAlbedo(alpha, 1.0f / eta).mean());
  crossing = mean_fresnel_transmittance(eta);
}

}  // namespace becalm::tracer
