// Metals: GGX microfacets of perfect mirrors, visible-normal sampling, and a cosine lobe for what leaves the
// microsurface after further bounces. Included by bsdf.cpp alone.

namespace becalm::tracer {
namespace {

V3f fresnel(const ConductorBsdf& bsdf, float cos_o) {
  return {fresnel_conductor(cos_o, bsdf.eta.x, bsdf.k.x), fresnel_conductor(cos_o, bsdf.eta.y, bsdf.k.y),
          fresnel_conductor(cos_o, bsdf.eta.z, bsdf.k.z)};
}

bool is_specular_model(const ConductorBsdf& bsdf) {
  return bsdf.alpha < kSmoothAlpha;
}

/// The lobe of further bounces.
class FurtherBounces {
 public:
  explicit FurtherBounces(const ConductorBsdf& bsdf)
      : shape_{bsdf.alpha, 1.0f}, facing_(fresnel(bsdf, 1.0f)), gain_(0.0f) {
    const GgxAlbedo parts = PrincipledTables::get().mean_albedo(shape_);
    const float mean = std::min(1.0f, parts.f0 + parts.f90);
    for (int c = 0; c < 3; ++c) {
      gain_[c] = multiple_scattering_gain(mean) * multiple_scattering_color(facing_[c], 1.0f, mean);
    }
    strongest_ = max_component(gain_) * (1.0f - mean);
  }

  /// Share of uniform light that one scattering loses, at a cosine in [0,1].
  float lost(float cosine) const {
    const GgxAlbedo once = PrincipledTables::get().albedo(cosine, shape_);
    return std::max(0.0f, 1.0f - once.f0 - once.f90);
  }
  /// With which it is sampled, where `lost` is that of wo.
  float probability(float lost) const {
    const float further = strongest_ * lost;
    const float once = max_component(facing_) * (1.0f - lost);
    return further > 0.0f ? further / (further + once) : 0.0f;
  }
  const V3f& gain() const { return gain_; }

 private:
  GgxShape shape_;
  V3f facing_;
  V3f gain_;
  float strongest_ = 0.0f;
};

/// Of a rough conductor, for directions above the surface.
BsdfValue evaluate_upper(const ConductorBsdf& bsdf, const FurtherBounces& further, float lost, const V3f& o,
                         const V3f& i) {
  const V3f m = (o + i).normalized();
  const float p = further.probability(lost);
  const float cos_pi = i.z * std::numbers::inv_pi_v<float>;
  return {fresnel(bsdf, std::clamp(o.dot(m), 0.0f, 1.0f)) * mirrored(o, i, m, bsdf.alpha) +
              further.gain() * (lost * further.lost(std::min(1.0f, i.z)) * cos_pi),
          (1.0f - p) * pdf_mirrored_normal(o, m, bsdf.alpha) + p * cos_pi};
}

BsdfValue evaluate_model(const ConductorBsdf& bsdf, const V3f& wo, const V3f& wi) {
  if (!same_side(wo, wi) || is_specular_model(bsdf)) return {V3f(0.0f), 0.0f};
  const V3f o = upper(wo);
  const FurtherBounces further(bsdf);
  return evaluate_upper(bsdf, further, further.lost(std::min(1.0f, o.z)), o, upper(wi));
}

V3f eval_model(const ConductorBsdf& bsdf, const V3f& wo, const V3f& wi) {
  return evaluate_model(bsdf, wo, wi).f_cos;
}

float pdf_model(const ConductorBsdf& bsdf, const V3f& wo, const V3f& wi) {
  return evaluate_model(bsdf, wo, wi).pdf_solid_angle;
}

std::optional<BsdfSample> sample_model(const ConductorBsdf& bsdf, const V3f& wo, const V2f& u, float u_lobe) {
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
  const FurtherBounces further(bsdf);
  const float lost = further.lost(std::min(1.0f, o.z));
  V3f i;
  if (u_lobe < further.probability(lost)) {
    const std::optional<BsdfSample> cosine = sample_model(DiffuseBsdf{V3f(1.0f)}, o, u, 0.0f);
    if (!cosine) return std::nullopt;
    i = cosine->wi;
  } else {
    i = reflect(o, ggx_sample_visible_normal(o, bsdf.alpha, u)).normalized();
  }
  if (i.z <= 0.0f) return std::nullopt;
  const BsdfValue value = evaluate_upper(bsdf, further, lost, o, i);
  if (!(value.pdf_solid_angle > 0.0f) || !std::isfinite(value.pdf_solid_angle)) return std::nullopt;
  return BsdfSample{.wi = V3f(i.x, i.y, std::copysign(i.z, wo.z)),
                    .weight = value.f_cos / value.pdf_solid_angle,
                    .pdf = value.pdf_solid_angle,
                    .specular = false,
                    .transmitted = false,
                    .radiance_scale = 1.0f};
}

V3f albedo_model(const ConductorBsdf& bsdf) {
  return fresnel(bsdf, 1.0f);
}

}  // namespace
}  // namespace becalm::tracer
