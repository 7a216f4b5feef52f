// What every BSDF promises: weight = value / pdf, reciprocity, delta lobes, finite values at the extremes.
#include "tracer/materials/bsdf.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/tracer/shading/bsdf_values.h"
#include "tests/tracer/shading/statistics.h"
#include "tests/tracer/shading/test_directions.h"
#include "tracer/materials/conductor_ior.h"
#include "tracer/math/shading_frame.h"

namespace becalm::tracer {
namespace {

struct Named {
  std::string name;
  Bsdf bsdf;
};

const V3f kGoldEta(0.18f, 0.42f, 1.37f);
const V3f kGoldK(3.42f, 2.35f, 1.77f);

std::vector<Named> rough_bsdfs() {
  std::vector<Named> list = {{"diffuse", DiffuseBsdf{V3f(0.2f, 0.5f, 0.8f)}}};
  for (const float alpha : {0.02f, 0.2f, 1.0f}) {
    list.push_back({fmt::format("conductor alpha {}", alpha), ConductorBsdf{kGoldEta, kGoldK, alpha}});
    for (const float eta : {0.6f, 1.1f, 1.5f, 2.4f}) {
      list.push_back({fmt::format("dielectric eta {} alpha {}", eta, alpha),
                      DielectricBsdf{eta, alpha, V3f(0.9f, 0.6f, 0.3f)}});
    }
  }
  return list;
}

TEST(Bsdf, sample_weight_is_value_over_pdf) {
  for (const auto& [name, bsdf] : rough_bsdfs()) {
    for (const float theta : {1.0f, 45.0f, 80.0f, 89.0f, 100.0f, 150.0f}) {
      const V3f wo = direction(theta, 20.0f);
      TestRandom random(7);
      for (int i = 0; i < 500; ++i) {
        const V2f u = random.next_2d();
        const float u_lobe = random.next();
        const auto drawn = sample(bsdf, wo, u, u_lobe);
        if (!drawn) continue;
        const std::string replay =
            fmt::format("{} theta {} u {} {} u_lobe {}", name, theta, u.x, u.y, u_lobe);
        ASSERT_NEAR(drawn->wi.length(), 1.0f, 1e-6f) << replay;
        ASSERT_FALSE(drawn->specular) << replay;
        ASSERT_EQ(drawn->transmitted, wo.z * drawn->wi.z < 0.0f) << replay;
        const float pdf = pdf_of(bsdf, wo, drawn->wi);
        const V3f value = value_of(bsdf, wo, drawn->wi);
        // The half vector is recovered from rounded directions: 1e-7 of direction in a lobe 0.02 wide, more
        // at grazing angles and where refraction hardly turns.
        ASSERT_NEAR(pdf / drawn->pdf_solid_angle, 1.0f, 0.02f) << replay;
        for (int c = 0; c < 3; ++c) {
          ASSERT_NEAR(value[c] / pdf, drawn->weight[c], 2e-3f * drawn->weight[c] + 1e-6f) << replay;
        }
      }
    }
  }
}

TEST(Bsdf, radiance_scale_is_the_squared_ratio_of_indices) {
  for (const float alpha : {0.0f, 0.3f}) {
    const Bsdf glass = DielectricBsdf{1.5f, alpha, V3f(1.0f)};
    for (const bool outside : {true, false}) {
      const V3f wo = direction(outside ? 20.0f : 160.0f, 0.0f);
      const auto through = sample(glass, wo, V2f(0.1f, 0.2f), 0.99f);
      ASSERT_TRUE(through && through->transmitted);
      EXPECT_FLOAT_EQ(through->radiance_scale, outside ? 1.0f / 2.25f : 2.25f);
      const auto back = sample(glass, wo, V2f(0.1f, 0.2f), 0.0f);
      ASSERT_TRUE(back && !back->transmitted);
      EXPECT_EQ(back->radiance_scale, 1.0f);
    }
  }
}

/// f(wo, wi) / n_wo^2 is symmetric: Helmholtz reciprocity with the compression of radiance taken out (n = 1
/// outside).
TEST(Bsdf, reciprocity) {
  for (const auto& [name, bsdf] : rough_bsdfs()) {
    const auto* glass = std::get_if<DielectricBsdf>(&bsdf);
    const auto n2 = [&](const V3f& w) {
      return glass != nullptr && w.z < 0.0f ? glass->eta * glass->eta : 1.0f;
    };
    TestRandom random(11);
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
      const V3f wo = direction(180.0f * random.next(), 360.0f * random.next());
      const auto drawn = sample(bsdf, wo, random.next_2d(), random.next());
      if (!drawn || std::min(std::abs(wo.z), std::abs(drawn->wi.z)) < 0.01f) continue;
      const V3f wi = drawn->wi;
      const float forward = value_of(bsdf, wo, wi).x / (std::abs(wi.z) * n2(wo));
      const float backward = value_of(bsdf, wi, wo).x / (std::abs(wo.z) * n2(wi));
      ASSERT_NEAR(forward / backward, 1.0f, 0.01f) << name << " wo " << wo << " wi " << wi;
      ++compared;
    }
    EXPECT_GT(compared, 500) << name;
  }
}

TEST(Bsdf, smooth_conductor_mirrors) {
  const Bsdf mirror = ConductorBsdf{kGoldEta, kGoldK, 0.0f};
  EXPECT_TRUE(is_specular(mirror));
  for (const float theta : {30.0f, 150.0f}) {
    const V3f wo = direction(theta, 40.0f);
    const auto drawn = sample(mirror, wo, V2f(0.3f, 0.7f), 0.5f);
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->wi, V3f(-wo.x, -wo.y, wo.z));
    EXPECT_TRUE(drawn->specular);
    EXPECT_EQ(drawn->pdf_solid_angle, 0.0f);
    EXPECT_EQ(value_of(mirror, wo, drawn->wi), V3f(0.0f));
    EXPECT_EQ(pdf_of(mirror, wo, drawn->wi), 0.0f);
  }
}

TEST(Bsdf, smooth_dielectric_refracts_by_snells_law) {
  const Bsdf glass = DielectricBsdf{1.5f, 0.0f, V3f(1.0f)};
  EXPECT_TRUE(is_specular(glass));
  const V3f wo = direction(40.0, 0.0);
  const auto in = sample(glass, wo, V2f(0.0f), 0.999f);
  ASSERT_TRUE(in && in->transmitted && in->specular);
  EXPECT_NEAR(-in->wi.x * 1.5f, wo.x, 1e-6f);
  EXPECT_LT(in->wi.z, 0.0f);
  // Back along the way it came.
  const auto out = sample(glass, in->wi, V2f(0.0f), 0.999f);
  ASSERT_TRUE(out && out->transmitted);
  EXPECT_NEAR((out->wi - wo).length(), 0.0f, 1e-6f);
  // Total reflection inside, beyond asin(1 / 1.5) = 41.8 degrees, whatever u_lobe.
  for (const float u_lobe : {0.0f, 0.5f, 0.9999999f}) {
    const auto total = sample(glass, direction(180.0 - 42.0, 0.0), V2f(0.0f), u_lobe);
    ASSERT_TRUE(total && !total->transmitted);
    EXPECT_EQ(total->weight, V3f(1.0f));
  }
}

TEST(Bsdf, matched_index_passes_straight_through) {
  for (const float alpha : {0.0f, 0.3f, 1.0f}) {
    for (const float eta : {1.0f, 1.00005f}) {
      const Bsdf glass = DielectricBsdf{eta, alpha, V3f(0.7f)};
      EXPECT_TRUE(is_specular(glass));
      const V3f wo = direction(50.0, 10.0);
      const auto drawn = sample(glass, wo, V2f(0.4f, 0.6f), 0.5f);
      ASSERT_TRUE(drawn && drawn->transmitted);
      EXPECT_LT((drawn->wi + wo).length(), 2e-4f);
      EXPECT_NEAR(drawn->weight.x, 0.7f, 2e-4f);
    }
  }
}

TEST(Bsdf, opaque_dielectric_only_reflects) {
  for (const float alpha : {0.0f, 0.3f}) {
    const Bsdf coat = DielectricBsdf{1.5f, alpha, V3f(0.0f)};
    const auto drawn = sample(coat, direction(30.0, 0.0), V2f(0.5f, 0.1f), 0.9999999f);
    ASSERT_TRUE(drawn && !drawn->transmitted);
    EXPECT_LT(drawn->weight.x, 0.06f);
  }
  // Index-matched and opaque: nothing is left.
  EXPECT_FALSE(sample(DielectricBsdf{1.0f, 0.0f, V3f(0.0f)}, direction(30.0, 0.0), V2f(0.5f), 0.5f));
}

TEST(Bsdf, albedo_lies_in_the_unit_interval) {
  EXPECT_EQ(albedo(DiffuseBsdf{V3f(0.1f, 0.2f, 0.3f)}), V3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(albedo(DiffuseBsdf{V3f(-1.0f, 2.0f, 0.5f)}), V3f(0.0f, 1.0f, 0.5f));
  EXPECT_EQ(albedo(DielectricBsdf{1.5f, 0.2f, V3f(1.0f)}), V3f(1.0f));
  const V3f wanted(0.95f, 0.6f, 0.2f);
  const ConductorIor ior = conductor_from_reflectance(wanted);
  EXPECT_LT((albedo(ConductorBsdf{ior.eta, ior.k, 0.2f}) - wanted).length(), 1e-5f);
}

TEST(Bsdf, roughness_maps_to_its_square) {
  EXPECT_EQ(roughness_to_alpha(0.0f), 0.0f);
  EXPECT_FLOAT_EQ(roughness_to_alpha(0.3f), 0.09f);
  EXPECT_EQ(roughness_to_alpha(1.0f), 1.0f);
  EXPECT_EQ(roughness_to_alpha(7.0f), 1.0f);
}

bool usable(float v) {
  return std::isfinite(v) && v >= 0.0f;
}
bool usable(const V3f& v) {
  return usable(v.x) && usable(v.y) && usable(v.z);
}

TEST(Bsdf, finite_at_the_extremes) {
  std::vector<Named> list = {{"diffuse", DiffuseBsdf{V3f(1.0f)}}};
  for (const float alpha : {0.0f, 9.9e-5f, 1e-4f, 1e-3f, 1.0f}) {
    for (const float eta : {0.0f, 1.0f, 1e20f}) {
      for (const float k : {0.0f, 1e-20f, 1e20f}) {
        list.push_back(
            {fmt::format("conductor {} {} {}", eta, k, alpha), ConductorBsdf{V3f(eta), V3f(k), alpha}});
      }
    }
    for (const float eta : {1e-3f, 0.9999f, 1.0f, 1.0001f, 1.01f, 1e3f}) {
      list.push_back({fmt::format("dielectric {} {}", eta, alpha), DielectricBsdf{eta, alpha, V3f(1.0f)}});
    }
  }
  constexpr float last_below_one = 0x1.fffffep-1f;  // the largest float below 1
  for (const auto& [name, bsdf] : list) {
    EXPECT_TRUE(usable(albedo(bsdf))) << name;
    for (const float cos_o : {0.0f, 1e-40f, 1e-20f, 1e-8f, 1e-3f, 0.5f, 1.0f}) {
      for (const float side : {1.0f, -1.0f}) {
        const V3f wo(std::sqrt(1.0f - cos_o * cos_o), 0.0f, side * cos_o);
        for (const float ux : {0.0f, 0.25f, last_below_one}) {
          for (const float uy : {0.0f, 0.5f, last_below_one}) {
            for (const float u_lobe : {0.0f, 0.5f, last_below_one}) {
              const std::string replay = fmt::format("{} wo.z {} u {} {} {}", name, wo.z, ux, uy, u_lobe);
              const auto drawn = sample(bsdf, wo, V2f(ux, uy), u_lobe);
              if (!drawn) continue;
              ASSERT_TRUE(usable(drawn->weight)) << replay << " weight " << drawn->weight;
              // Further bounces between microfacets are sampled by the cosine.
              const bool further = !is_specular(bsdf) && !std::holds_alternative<DiffuseBsdf>(bsdf);
              const float largest = further ? 10.0f : 1.00001f;
              ASSERT_LE(drawn->weight.x, drawn->radiance_scale * largest) << replay;
              ASSERT_TRUE(usable(drawn->pdf_solid_angle)) << replay << " pdf " << drawn->pdf_solid_angle;
              ASSERT_EQ(drawn->pdf_solid_angle == 0.0f, drawn->specular) << replay;
              ASSERT_NEAR(drawn->wi.length(), 1.0f, 1e-5f) << replay;
              ASSERT_NE(drawn->wi.z, 0.0f) << replay;
              ASSERT_TRUE(usable(value_of(bsdf, wo, drawn->wi))) << replay;
              ASSERT_TRUE(usable(pdf_of(bsdf, wo, drawn->wi))) << replay;
              const V3f elsewhere = direction(180.0 * uy, 360.0 * ux);
              ASSERT_TRUE(usable(value_of(bsdf, wo, elsewhere))) << replay;
              ASSERT_TRUE(usable(value_of(bsdf, elsewhere, wo))) << replay;
              ASSERT_TRUE(usable(pdf_of(bsdf, wo, elsewhere))) << replay;
              ASSERT_TRUE(usable(pdf_of(bsdf, elsewhere, wo))) << replay;
            }
          }
        }
      }
    }
  }
}

TEST(ShadingFrame, is_orthonormal_and_right_handed) {
  for (const V3f& n : {V3f(0, 0, 1), V3f(0, 0, -1), V3f(1, 0, 0), V3f(0, -1, 0),
                       V3f(1e-8f, 0, -1).normalized(), V3f(-1, 2, -3).normalized()}) {
    const ShadingFrame frame = ShadingFrame::from_normal(n);
    EXPECT_NEAR((frame.tangent.cross(frame.bitangent) - n).length(), 0.0f, 1e-6f) << n;
    EXPECT_NEAR(frame.tangent.dot(frame.bitangent), 0.0f, 1e-6f) << n;
    EXPECT_NEAR((frame.to_world(V3f(0, 0, 1)) - n).length(), 0.0f, 1e-6f) << n;
    const V3f v(0.3f, -0.5f, 0.8f);
    EXPECT_NEAR((frame.to_world(frame.to_local(v)) - v).length(), 0.0f, 1e-6f) << n;
  }
}

}  // namespace
}  // namespace becalm::tracer
