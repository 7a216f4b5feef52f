// The principled model over the corners of its parameters: energy, reciprocity, sampler and density,
// extremes.
#include "tracer/materials/principled.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "tests/tracer/shading/bsdf_values.h"
#include "tests/tracer/shading/statistics.h"
#include "tests/tracer/shading/test_directions.h"
#include "tracer/materials/principled_tables.h"

namespace becalm::tracer {
namespace {

struct Named {
  std::string name;
  PrincipledParameters parameters;
};

const V3f kWhite(1.0f);

/// All corners of the parameters that change the layers, and some insides. White.
std::vector<Named> corners() {
  std::vector<Named> list;
  for (const float roughness : {0.0f, 0.1f, 0.4f, 0.7f, 1.0f}) {
    for (const float metallic : {0.0f, 0.5f, 1.0f}) {
      for (const float anisotropy : {0.0f, 0.5f, 1.0f}) {
        for (const float clearcoat : {0.0f, 1.0f}) {
          for (const float sheen : {0.0f, 1.0f}) {
            for (const float transmission : {0.0f, 0.5f, 1.0f}) {
              if (metallic == 1.0f && transmission > 0.0f) continue;
              list.push_back(
                  {fmt::format("roughness {} metallic {} anisotropy {} clearcoat {} sheen {} transmission {}",
                               roughness, metallic, anisotropy, clearcoat, sheen, transmission),
                   {.base_color = kWhite,
                    .metallic = metallic,
                    .roughness = roughness,
                    .anisotropy = anisotropy,
                    .sheen = sheen,
                    .clearcoat = clearcoat,
                    .clearcoat_roughness = 1.0f - roughness,
                    .transmission = transmission}});
            }
          }
        }
      }
    }
  }
  return list;
}

Bsdf make(const PrincipledParameters& parameters) {
  return make_principled(parameters);
}

struct Energy {
  double mean = 0.0;
  double largest_sample = 0.0;
};

/// What is reflected and transmitted of uniform light of radiance 1, without the compression of radiance. By
/// points of an additive recurrence (roots of x^4 = x + 1), whose error is some 1 / samples.
Energy energy(const Bsdf& bsdf, const V3f& wo, int samples) {
  constexpr double root = 1.2207440846057596;
  double x = 0.5, y = 0.5, z = 0.5;
  const auto advance = [](double& v, double step) { v = std::fmod(v + step, 1.0); };
  Energy result;
  for (int i = 0; i < samples; ++i) {
    advance(x, 1.0 / root);
    advance(y, 1.0 / (root * root));
    advance(z, 1.0 / (root * root * root));
    const auto number = [](double v) { return std::min(static_cast<float>(v), 0x1.fffffep-1f); };
    const auto drawn = sample(bsdf, wo, V2f(number(x), number(y)), number(z));
    const double value = drawn ? max_component(drawn->weight) / drawn->radiance_scale : 0.0;
    result.mean += value / samples;
    result.largest_sample = std::max(result.largest_sample, value);
  }
  return result;
}

TEST(Principled, never_returns_more_light_than_it_receives) {
  for (const auto& [name, parameters] : corners()) {
    for (const V3f& wo : {direction(3.0, 20.0), direction(60.0, 0.0), direction(85.0, 90.0),
                          direction(parameters.transmission > 0.0f ? 140.0 : 88.0, 40.0)}) {
      Energy e = energy(make(parameters), wo, 2000);
      if (e.mean > 1.0) e = energy(make(parameters), wo, 60000);  // was it the points?
      EXPECT_LT(e.mean, 1.001) << name << " wo " << wo;
      EXPECT_LT(e.largest_sample, 25.0) << name << " wo " << wo;
    }
  }
}

TEST(Principled, a_widened_lobe_returns_no_more_light_than_it_receives) {
  for (const auto& [name, parameters] : corners()) {
    for (const float slope_variance : {0.02f, 0.25f, 1.0f}) {
      Bsdf widened = make(parameters);
      widen(widened, slope_variance);
      for (const V3f& wo : {direction(3.0, 20.0), direction(85.0, 90.0)}) {
        Energy e = energy(widened, wo, 1000);
        if (e.mean > 1.0) e = energy(widened, wo, 60000);  // was it the points?
        EXPECT_LT(e.mean, 1.001) << name << " widened by " << slope_variance << " wo " << wo;
      }
    }
  }
}

/// The margin of the tables is lost (0.3%), and more of polished metal at grazing angles (see
/// make_principled).
TEST(Principled, isotropic_metal_and_plastic_lose_nothing) {
  for (const float roughness : {0.0f, 0.1f, 0.25f, 0.4f, 0.6f, 0.8f, 1.0f}) {
    for (const float metallic : {0.0f, 0.5f, 1.0f}) {
      for (const double theta : {0.0, 30.0, 60.0, 80.0, 88.0}) {
        const Energy e = energy(make({.base_color = kWhite, .metallic = metallic, .roughness = roughness}),
                                direction(theta, 50.0), 20000);
        EXPECT_GT(e.mean, theta > 60.0 && roughness < 0.3f ? 0.95 : 0.99)
            << "roughness " << roughness << " metallic " << metallic << " theta " << theta;
        EXPECT_LT(e.mean, 1.002) << "roughness " << roughness << " metallic " << metallic << " theta "
                                 << theta;
      }
    }
  }
}

/// The bounds are the measured losses at these angles, rounded up: of azimuths that lose more than the least.
TEST(Principled, anisotropic_metal_loses_what_differs_between_azimuths) {
  struct Bound {
    float anisotropy;
    double largest_loss;
  };
  for (const auto& [anisotropy, largest_loss] : {Bound{0.25f, 0.06}, Bound{0.5f, 0.13}, Bound{1.0f, 0.31}}) {
    for (const float roughness : {0.2f, 0.4f, 0.6f, 0.8f, 1.0f}) {
      for (const double theta : {0.0, 60.0, 80.0}) {
        for (const double phi : {0.0, 45.0, 90.0}) {
          const Energy e = energy(
              make(
                  {.base_color = kWhite, .metallic = 1.0f, .roughness = roughness, .anisotropy = anisotropy}),
              direction(theta, phi), 4000);
          EXPECT_GT(e.mean, 1.0 - largest_loss)
              << anisotropy << " " << roughness << " " << theta << " " << phi;
        }
      }
    }
  }
}

TEST(Principled, albedo_is_what_it_reflects_facing) {
  for (const auto& [name, parameters] : corners()) {
    if (parameters.anisotropy > 0.0f || parameters.transmission > 0.0f) continue;
    // Layers above the base shade it from both sides, which the albedo counts once.
    const double tolerance = parameters.sheen + parameters.clearcoat > 0.0f ? 0.05 : 0.02;
    PrincipledParameters colored = parameters;
    colored.base_color = V3f(0.5f, 0.2f, 0.8f);
    // The estimate's strongest channel is blue, as the albedo's.
    const Energy e = energy(make(colored), V3f(0.0f, 0.0f, 1.0f), 20000);
    EXPECT_NEAR(albedo(make(colored)).z, e.mean, tolerance) << name;
  }
}

std::vector<Named> colored() {
  const V3f color(0.9f, 0.5f, 0.2f);
  return {{"plastic", {.base_color = color, .roughness = 0.3f}},
          {"rough", {.base_color = color, .roughness = 1.0f}},
          {"brushed metal",
           {.base_color = color,
            .metallic = 1.0f,
            .roughness = 0.4f,
            .anisotropy = 0.9f,
            .anisotropy_rotation = 0.1f}},
          {"coated",
           {.base_color = color,
            .metallic = 0.4f,
            .roughness = 0.6f,
            .clearcoat = 1.0f,
            .clearcoat_roughness = 0.2f}},
          {"velvet",
           {.base_color = color, .roughness = 0.8f, .anisotropy = 0.5f, .sheen = 1.0f, .sheen_tint = 0.5f}},
          {"all",
           {.base_color = color,
            .metallic = 0.3f,
            .roughness = 0.5f,
            .anisotropy = 0.7f,
            .anisotropy_rotation = 0.3f,
            .sheen = 0.5f,
            .clearcoat = 0.7f,
            .clearcoat_roughness = 0.5f,
            .transmission = 0.5f}},
          {"glass", {.base_color = color, .roughness = 0.5f, .transmission = 1.0f}}};
}

TEST(Principled, sampler_matches_its_density) {
  std::uint32_t seed = 900;
  const std::vector<Named> list = colored();
  const std::vector<double> thetas = {0.0, 45.0, 85.0, 130.0};
  const double level = sidak_level(0.01, static_cast<int>(list.size() * thetas.size()));
  for (const auto& [name, parameters] : list) {
    const Bsdf bsdf = make(parameters);
    for (const double theta : thetas) {
      const V3f wo = direction(theta, 200.0);
      const auto draw = [&](TestRandom& random) -> std::optional<V3f> {
        const V2f u = random.next_2d();
        const auto drawn = sample(bsdf, wo, u, random.next());
        return drawn ? std::optional(drawn->wi) : std::nullopt;
      };
      const auto pdf = [&](const V3f& wi) { return pdf_of(bsdf, wo, wi); };
      const SamplerTest test = test_sampler(sphere_chart(draw, pdf), ++seed, 40000, 128);
      EXPECT_GT(test.result.p_value, level) << name << " theta " << theta << " " << test.replay;
      EXPECT_LT(test.integral, 1.001) << name << " theta " << theta;
    }
  }
}

TEST(Principled, weight_is_eval_over_pdf) {
  for (const auto& [name, parameters] : colored()) {
    const Bsdf bsdf = make(parameters);
    TestRandom random(3);
    for (int i = 0; i < 2000; ++i) {
      const V3f wo = direction(180.0 * random.next(), 360.0 * random.next());
      const auto drawn = sample(bsdf, wo, random.next_2d(), random.next());
      if (!drawn) continue;
      ASSERT_FALSE(drawn->specular) << name;
      ASSERT_EQ(drawn->transmitted, wo.z * drawn->wi.z < 0.0f) << name;
      const V3f expected = value_of(bsdf, wo, drawn->wi) / pdf_of(bsdf, wo, drawn->wi);
      ASSERT_LT((drawn->weight - expected).length(), 1e-4f * expected.length() + 1e-6f)
          << name << " wo " << wo;
      ASSERT_NEAR(drawn->pdf_solid_angle / pdf_of(bsdf, wo, drawn->wi), 1.0f, 1e-3f) << name;
    }
  }
}

TEST(Principled, is_reciprocal_without_glass) {
  for (const auto& [name, parameters] : colored()) {
    if (parameters.transmission > 0.0f) continue;
    const Bsdf bsdf = make(parameters);
    TestRandom random(5);
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
      const V3f wo = direction(180.0 * random.next(), 360.0 * random.next());
      const auto drawn = sample(bsdf, wo, random.next_2d(), random.next());
      if (!drawn || std::min(std::abs(wo.z), std::abs(drawn->wi.z)) < 0.01f) continue;
      const V3f wi = drawn->wi;
      const V3f forward = value_of(bsdf, wo, wi) / std::abs(wi.z),
                backward = value_of(bsdf, wi, wo) / std::abs(wo.z);
      ASSERT_LT((forward - backward).length(), 1e-3f * forward.length())
          << name << " wo " << wo << " wi " << wi;
      ++compared;
    }
    EXPECT_GT(compared, 500) << name;
  }
}

/// The highlight is longer along the tangent, and turns with the rotation.
TEST(Principled, anisotropy_follows_the_tangent) {
  PrincipledParameters p{.base_color = kWhite, .metallic = 1.0f, .roughness = 0.3f, .anisotropy = 1.0f};
  const V3f facing(0.0f, 0.0f, 1.0f), along = direction(20.0, 0.0), across = direction(20.0, 90.0);
  EXPECT_GT(value_of(make(p), facing, along).x, 5.0f * value_of(make(p), facing, across).x);
  p.anisotropy_rotation = 0.25f;
  EXPECT_GT(value_of(make(p), facing, across).x, 5.0f * value_of(make(p), facing, along).x);
  p.anisotropy_rotation = 0.125f;
  EXPECT_GT(value_of(make(p), facing, direction(20.0, 45.0)).x,
            5.0f * value_of(make(p), facing, direction(20.0, -45.0)).x)
      << "counter-clockwise";
}

TEST(Principled, delta_lobes) {
  const V3f wo = direction(40.0, 10.0);
  const Bsdf mirror = make({.base_color = V3f(0.9f, 0.6f, 0.3f), .metallic = 1.0f, .roughness = 0.0f});
  EXPECT_TRUE(is_specular(mirror));
  const auto reflected = sample(mirror, wo, V2f(0.5f), 0.5f);
  ASSERT_TRUE(reflected && reflected->specular);
  EXPECT_EQ(reflected->wi, V3f(-wo.x, -wo.y, wo.z));
  EXPECT_NEAR(reflected->weight.y, 0.6f, 0.01f);
  EXPECT_TRUE(is_specular(make({.base_color = kWhite, .roughness = 0.0f, .transmission = 1.0f})));
  EXPECT_TRUE(
      is_specular(make({.base_color = kWhite, .roughness = 0.5f, .ior = 1.0f, .transmission = 1.0f})));
  EXPECT_FALSE(is_specular(make({.base_color = kWhite, .roughness = 0.0f}))) << "diffuse below";
  EXPECT_FALSE(is_specular(make({.metallic = 1.0f, .roughness = 0.3f, .clearcoat = 1.0f})));
  EXPECT_TRUE(is_specular(make({.metallic = 1.0f, .roughness = 0.0f, .clearcoat = 1.0f})));
  // A polished coat over diffuse: some samples are delta, and its value has none of it.
  const Bsdf coated = make({.base_color = V3f(0.0f), .roughness = 1.0f, .ior = 1.0f, .clearcoat = 1.0f});
  int delta = 0;
  for (int i = 0; i < 100; ++i) {
    const auto drawn = sample(coated, wo, V2f(0.3f, 0.6f), (static_cast<float>(i) + 0.5f) / 100.0f);
    delta += drawn && drawn->specular ? 1 : 0;
  }
  EXPECT_GT(delta, 90);
  EXPECT_EQ(value_of(coated, wo, V3f(-wo.x, -wo.y, wo.z)), V3f(0.0f));
}

TEST(Principled, an_index_of_1_leaves_the_diffuse_base) {
  const Bsdf bsdf = make({.base_color = V3f(0.3f), .roughness = 1.0f, .ior = 1.0f});
  const V3f wo = direction(70.0, 0.0), wi = direction(60.0, 120.0);
  EXPECT_NEAR(value_of(bsdf, wo, wi).x, 0.3f * wi.z / std::numbers::pi_v<float>, 1e-6f);
}

TEST(Principled, finite_at_the_extremes) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinity = std::numeric_limits<float>::infinity();
  std::vector<Named> list = corners();
  for (const float bad : {nan, infinity, -infinity, -1.0f, 1e30f, 1e-30f}) {
    list.push_back(
        {fmt::format("all {}", bad), {V3f(bad), bad, bad, bad, bad, bad, bad, bad, bad, bad, bad}});
    list.push_back({fmt::format("ior {}", bad), {.ior = bad, .transmission = 0.5f}});
    list.push_back({fmt::format("roughness {}", bad),
                    {.metallic = 0.5f,
                     .roughness = bad,
                     .anisotropy = 1.0f,
                     .clearcoat = 1.0f,
                     .clearcoat_roughness = bad}});
  }
  const auto usable = [](const V3f& v) { return is_finite(v) && std::min({v.x, v.y, v.z}) >= 0.0f; };
  constexpr float last_below_one = 0x1.fffffep-1f;
  for (const auto& [name, parameters] : list) {
    const Bsdf bsdf = make(parameters);
    ASSERT_TRUE(usable(albedo(bsdf))) << name;
    for (const float cos_o : {0.0f, 1e-40f, 1e-20f, 1e-3f, 1.0f}) {
      for (const float side : {1.0f, -1.0f}) {
        const V3f wo(std::sqrt(1.0f - cos_o * cos_o), 0.0f, side * cos_o);
        for (const float ux : {0.0f, 0.3f, last_below_one}) {
          for (const float uy : {0.0f, last_below_one}) {
            for (const float u_lobe : {0.0f, 0.3f, 0.7f, last_below_one}) {
              const auto drawn = sample(bsdf, wo, V2f(ux, uy), u_lobe);
              if (!drawn) continue;
              const std::string replay = fmt::format("{} wo.z {} u {} {} {}", name, wo.z, ux, uy, u_lobe);
              ASSERT_TRUE(usable(drawn->weight)) << replay << " weight " << drawn->weight;
              ASSERT_TRUE(std::isfinite(drawn->pdf_solid_angle) && drawn->pdf_solid_angle >= 0.0f) << replay;
              ASSERT_EQ(drawn->pdf_solid_angle == 0.0f, drawn->specular) << replay;
              ASSERT_NEAR(drawn->wi.length(), 1.0f, 1e-5f) << replay;
              ASSERT_TRUE(usable(value_of(bsdf, wo, drawn->wi))) << replay;
              ASSERT_TRUE(usable(value_of(bsdf, drawn->wi, wo))) << replay;
              ASSERT_TRUE(std::isfinite(pdf_of(bsdf, drawn->wi, wo))) << replay;
            }
          }
        }
      }
    }
  }
  EXPECT_LE(sizeof(Bsdf), 96u) << "copied at every vertex of a path";
}

}  // namespace
}  // namespace becalm::tracer
