// The principled model, after Burley ("Physically-Based Shading at Disney", 2012) in its parameters, made of
// parts that keep energy and, without glass, are reciprocal. Included by bsdf.cpp alone.
//
//   f = f_coat + Tc (f_sheen + Ts f_base)
//   f_base = metal f_m + (1 - metal - glass) (f_d + f_diffuse) + glass f_glass
//
// f_coat, f_m and f_d are GGX microfacets with Schlick's Fresnel. A layer that reflects E(cos) of uniform
// light leaves T = min(1 - E(wo), 1 - E(wi)) to what lies below: symmetric, and since T <= 1 - E(wo) the sum
// never exceeds 1. f_m and f_d include what leaves the microsurface after further bounces, as the lobe (1 -
// E1(wo)) (1 - E1(wi)) / (pi (1 - mean E1)) of Kulla and Conty ("Revisiting Physically Based Shading at
// Imageworks", 2017), E1 the albedo of one scattering without absorption. The diffuse part lies below the
// dielectric's surface of albedo E as Kelemen and Szirmay-Kalos (2001) couple them: base_color
// (1 - E(wo)) (1 - E(wi)) / (pi (1 - mean E)), which with a white base returns all that the surface lets
// through. f_glass is DielectricBsdf's with the root of base_color as tint, since light crosses two of them.
//
// What is cosine-like (diffuse, sheen, multiple scattering) is one lobe of the sampler; coat, specular and
// glass are one each, chosen by what they reflect at wo.

namespace becalm::tracer {
namespace {

enum PrincipledLobe { kCosine, kSpecular, kCoat, kGlass, kLobes };

float schlick(float cosine) {
  const float v = 1.0f - std::clamp(cosine, 0.0f, 1.0f);
  const float v2 = v * v;
  return v2 * v2 * v;
}

bool specular_is_smooth(const PrincipledBsdf& bsdf) {
  return bsdf.alpha < kSmoothAlpha;
}
bool coat_is_smooth(const PrincipledBsdf& bsdf) {
  return bsdf.coat_alpha < kSmoothAlpha;
}
GgxAlpha specular_alpha(const PrincipledBsdf& bsdf) {
  return {bsdf.alpha / bsdf.aspect, bsdf.alpha * bsdf.aspect};
}
float diffuse_share(const PrincipledBsdf& bsdf) {
  return std::max(0.0f, 1.0f - bsdf.metal - bsdf.glass);
}

DielectricBsdf glass_of(const PrincipledBsdf& bsdf) {
  const V3f& c = bsdf.base_color;
  return {bsdf.eta, bsdf.alpha, V3f(std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z))};
}

/// The frame of the lobe's axes.
V3f turned_to_lobe(const PrincipledBsdf& bsdf, const V3f& w) {
  return {bsdf.rotation_cos * w.x + bsdf.rotation_sin * w.y,
          bsdf.rotation_cos * w.y - bsdf.rotation_sin * w.x, w.z};
}
V3f turned_from_lobe(const PrincipledBsdf& bsdf, const V3f& w) {
  return {bsdf.rotation_cos * w.x - bsdf.rotation_sin * w.y,
          bsdf.rotation_cos * w.y + bsdf.rotation_sin * w.x, w.z};
}

/// Fresnel reflectance of metal and dielectric together, each with its share.
V3f specular_fresnel(const PrincipledBsdf& bsdf, float cosine) {
  const float s = schlick(cosine);
  const float dielectric = diffuse_share(bsdf);
  const float f90 = bsdf.metal * f90_of(max_component(bsdf.base_color)) + dielectric * f90_of(bsdf.f0);
  return (bsdf.base_color * bsdf.metal + V3f(dielectric * bsdf.f0)) * (1.0f - s) + V3f(f90 * s);
}

float coat_fresnel(const PrincipledBsdf& bsdf, float cosine) {
  return bsdf.coat * (kCoatF0 + (1.0f - kCoatF0) * schlick(cosine));
}

/// Probabilities of the lobes seen from wo; all 0 when nothing is reflected.
using LobeProbabilities = std::array<float, kLobes>;

LobeProbabilities lobe_probabilities(const PrincipledBsdf& bsdf, const PrincipledAlbedo& at) {
  const float below_coat = 1.0f - at.coat;
  const float base = below_coat * (1.0f - at.sheen);
  const float strongest = max_component(bsdf.base_color);
  const float dielectric = diffuse_share(bsdf);
  const float f0 = bsdf.metal * strongest + dielectric * bsdf.f0;
  const float f90 = bsdf.metal * f90_of(strongest) + dielectric * f90_of(bsdf.f0);
  // Multiple scattering carries at most what one scattering lost.
  const float multiple = (bsdf.metal * strongest + dielectric * bsdf.multiple_f0) * at.lost();
  LobeProbabilities p;
  p[kCosine] = below_coat * at.sheen + base * (multiple + dielectric * strongest * (1.0f - at.dielectric));
  p[kSpecular] = base * (f0 * at.specular.f0 + f90 * at.specular.f90);
  p[kCoat] = at.coat;
  p[kGlass] = base * bsdf.glass;
  const float sum = p[kCosine] + p[kSpecular] + p[kCoat] + p[kGlass];
  for (float& each : p) each = sum > 0.0f ? each / sum : 0.0f;
  return p;
}

/// Of all lobes that are no delta functions.
BsdfValue evaluate_lobes(const PrincipledBsdf& bsdf, const PrincipledAlbedo& at_o, const LobeProbabilities& p,
                         const V3f& wo, const V3f& wi) {
  BsdfValue sum{V3f(0.0f), 0.0f};
  if (wo.z == 0.0f || wi.z == 0.0f) return sum;
  const PrincipledAlbedo at_i = principled_albedo(bsdf, std::min(1.0f, std::abs(wi.z)));
  const float below_coat = std::min(1.0f - at_o.coat, 1.0f - at_i.coat);
  const float base = below_coat * std::min(1.0f - at_o.sheen, 1.0f - at_i.sheen);

  if (bsdf.glass > 0.0f) {
    const BsdfValue glass = evaluate_model(glass_of(bsdf), wo, wi);
    sum.f_cos += glass.f_cos * (base * bsdf.glass);
    sum.pdf_solid_angle += p[kGlass] * glass.pdf_solid_angle;
  }
  if (!same_side(wo, wi)) return sum;

  const V3f o = upper(wo), i = upper(wi);
  const V3f m = (o + i).normalized();
  const float cos_m = o.dot(m);
  const float cos_pi = i.z * std::numbers::inv_pi_v<float>;
  const V3f diffuse = bsdf.base_color * (diffuse_share(bsdf) * bsdf.diffuse_gain * (1.0f - at_o.dielectric) *
                                         (1.0f - at_i.dielectric));
  sum.f_cos += (diffuse + bsdf.multiple * (at_o.lost() * at_i.lost())) * (base * cos_pi) +
               bsdf.sheen * (below_coat * schlick(cos_m) * i.z);
  sum.pdf_solid_angle += p[kCosine] * cos_pi;
  if (!specular_is_smooth(bsdf)) {
    const GgxAlpha alpha = specular_alpha(bsdf);
    const V3f lobe_o = turned_to_lobe(bsdf, o), lobe_i = turned_to_lobe(bsdf, i);
    const V3f lobe_m = turned_to_lobe(bsdf, m);
    sum.f_cos += specular_fresnel(bsdf, cos_m) * (base * mirrored(lobe_o, lobe_i, lobe_m, alpha));
    sum.pdf_solid_angle += p[kSpecular] * pdf_mirrored_normal(lobe_o, lobe_m, alpha);
  }
  if (bsdf.coat > 0.0f && !coat_is_smooth(bsdf)) {
    sum.f_cos += V3f(coat_fresnel(bsdf, cos_m) * mirrored(o, i, m, bsdf.coat_alpha));
    sum.pdf_solid_angle += p[kCoat] * pdf_mirrored_normal(o, m, bsdf.coat_alpha);
  }
  return sum;
}

BsdfValue evaluate_model(const PrincipledBsdf& bsdf, const V3f& wo, const V3f& wi) {
  const PrincipledAlbedo at_o = principled_albedo(bsdf, std::min(1.0f, std::abs(wo.z)));
  return evaluate_lobes(bsdf, at_o, lobe_probabilities(bsdf, at_o), wo, wi);
}

BsdfSample mirror_sample(const V3f& wo, const V3f& weight) {
  return {.wi = V3f(-wo.x, -wo.y, wo.z),
          .weight = weight,
          .pdf_solid_angle = 0.0f,
          .specular = true,
          .transmitted = false,
          .radiance_scale = 1.0f};
}

std::optional<BsdfSample> sample_model(const PrincipledBsdf& bsdf, const V3f& wo, const V2f& u,
                                       float u_lobe) {
  if (wo.z == 0.0f) return std::nullopt;
  const V3f o = upper(wo);
  const float cos_o = std::min(1.0f, o.z);
  const PrincipledAlbedo at_o = principled_albedo(bsdf, cos_o);
  const LobeProbabilities p = lobe_probabilities(bsdf, at_o);
  // The albedos at wo are those at the mirrored direction, so these are the layers' shares of delta lobes.
  const float base = (1.0f - at_o.coat) * (1.0f - at_o.sheen);

  int lobe = kCosine;
  while (lobe + 1 < kLobes && u_lobe >= p[lobe]) u_lobe -= p[lobe++];
  if (p[lobe] == 0.0f) return std::nullopt;

  V3f wi;
  float radiance_scale = 1.0f;
  switch (lobe) {
    case kCosine: {
      const std::optional<BsdfSample> cosine = sample_model(DiffuseBsdf{V3f(1.0f)}, wo, u, 0.0f);
      if (!cosine) return std::nullopt;
      wi = cosine->wi;
      break;
    }
    case kSpecular: {
      if (specular_is_smooth(bsdf)) {
        return mirror_sample(wo, specular_fresnel(bsdf, cos_o) * (base / p[kSpecular]));
      }
      const V3f lobe_o = turned_to_lobe(bsdf, o);
      const V3f m = ggx_sample_visible_normal(lobe_o, specular_alpha(bsdf), u);
      wi = turned_from_lobe(bsdf, reflect(lobe_o, m)).normalized();
      if (wi.z <= 0.0f) return std::nullopt;
      wi.z = std::copysign(wi.z, wo.z);
      break;
    }
    case kCoat: {
      if (coat_is_smooth(bsdf)) return mirror_sample(wo, V3f(coat_fresnel(bsdf, cos_o) / p[kCoat]));
      wi = reflect(o, ggx_sample_visible_normal(o, bsdf.coat_alpha, u)).normalized();
      if (wi.z <= 0.0f) return std::nullopt;
      wi.z = std::copysign(wi.z, wo.z);
      break;
    }
    default: {
      const float u_glass = std::clamp(u_lobe / p[kGlass], 0.0f, 0x1.fffffep-1f);
      std::optional<BsdfSample> glass = sample_model(glass_of(bsdf), wo, u, u_glass);
      if (!glass) return std::nullopt;
      if (glass->specular) {
        const PrincipledAlbedo at_i = principled_albedo(bsdf, std::min(1.0f, std::abs(glass->wi.z)));
        const float layers =
            std::min(1.0f - at_o.coat, 1.0f - at_i.coat) * std::min(1.0f - at_o.sheen, 1.0f - at_i.sheen);
        glass->weight *= layers * bsdf.glass / p[kGlass];
        return glass;
      }
      wi = glass->wi;
      radiance_scale = glass->radiance_scale;
    }
  }
  const BsdfValue value = evaluate_lobes(bsdf, at_o, p, wo, wi);
  if (!(value.pdf_solid_angle > 0.0f) || !std::isfinite(value.pdf_solid_angle)) return std::nullopt;
  return BsdfSample{.wi = wi,
                    .weight = value.f_cos / value.pdf_solid_angle,
                    .pdf_solid_angle = value.pdf_solid_angle,
                    .specular = false,
                    .transmitted = !same_side(wo, wi),
                    .radiance_scale = radiance_scale};
}

/// All lobes that can be drawn are delta functions.
bool is_specular_model(const PrincipledBsdf& bsdf) {
  const float dielectric = diffuse_share(bsdf);
  const bool diffuse = dielectric > 0.0f && !is_black(bsdf.base_color);
  const bool specular = dielectric > 0.0f || bsdf.metal > 0.0f;
  return (!specular || specular_is_smooth(bsdf)) && (bsdf.coat == 0.0f || coat_is_smooth(bsdf)) &&
         is_black(bsdf.sheen) && !diffuse && (bsdf.glass == 0.0f || !is_rough(bsdf.alpha, bsdf.eta));
}

/// Reflected and transmitted together, at normal incidence.
V3f albedo_model(const PrincipledBsdf& bsdf) {
  const PrincipledAlbedo at = principled_albedo(bsdf, 1.0f);
  const float below_coat = 1.0f - at.coat;
  const float dielectric = diffuse_share(bsdf);
  const float f90 = bsdf.metal * f90_of(max_component(bsdf.base_color)) + dielectric * f90_of(bsdf.f0);
  const GgxAlbedo mean = PrincipledTables::get().mean_albedo(specular_shape(bsdf));
  const V3f once = (bsdf.base_color * bsdf.metal + V3f(dielectric * bsdf.f0)) * at.specular.f0 +
                   V3f(f90 * at.specular.f90);
  const V3f multiple = bsdf.multiple * (at.lost() * (1.0f - mean.f0 - mean.f90));
  const V3f diffuse = bsdf.base_color * (dielectric * (1.0f - at.dielectric));
  const V3f glass = albedo_model(glass_of(bsdf)) * bsdf.glass;
  return V3f(at.coat) + bsdf.sheen * (below_coat * PrincipledTables::get().sheen_albedo(1.0f)) +
         (once + multiple + diffuse + glass) * (below_coat * (1.0f - at.sheen));
}

}  // namespace
}  // namespace becalm::tracer
