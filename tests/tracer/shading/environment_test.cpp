// Environments: orientation, sampling against density and radiance, and damaged or extreme images.
#include "tracer/lights/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "frame/error.h"
#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

constexpr double kPi = std::numbers::pi;

/// Dim sky, bright spot, black rows and a bright pole.
Image sky() {
  Image image(16, 8, 3);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) {
      for (int c = 0; c < 3; ++c) {
        image.at(x, y, c) = y >= 5 ? 0.0f : 0.1f * static_cast<float>(1 + (x * 5 + y * 3 + c) % 7);
      }
    }
  }
  for (int c = 0; c < 3; ++c) image.at(11, 2, c) = 60.0f;
  for (int x = 0; x < 16; ++x) image.at(x, 0, 1) = 2.0f;
  return image;
}

/// Without a normal.
const Receiver kAnywhere(V3f(0.0f));

/// Charts +y as the pole: the environment's frame turned into the chart's.
Chart chart_of(const Environment& environment) {
  const auto to_chart = [](const V3f& w) { return V3f(w.z, w.x, w.y); };
  const auto from_chart = [](const V3f& w) { return V3f(w.y, w.z, w.x); };
  Chart chart = sphere_chart(
      [&, to_chart](TestRandom& random) -> std::optional<V3f> {
        const auto drawn = environment.sample(kAnywhere, random.next_2d());
        return drawn ? std::optional(to_chart(drawn->dir_world)) : std::nullopt;
      },
      [&, from_chart](const V3f& w) { return environment.look(from_chart(w)).pdf_solid_angle(kAnywhere); });
  return chart;
}

TEST(Environment, image_samples_match_their_density) {
  const Environment environment = Environment::image(sky(), 2.0f, 0.0f);
  Chart chart = chart_of(environment);
  for (int i = 1; i < 16; ++i) chart.jumps_x.push_back(-kPi + i * kPi / 8);
  chart.jumps_y.clear();
  for (int i = 1; i < 8; ++i) chart.jumps_y.push_back(i * kPi / 8);
  const SamplerTest test = test_sampler(chart, 900, 200000);
  EXPECT_GT(test.result.p_value, 0.005) << test.replay;
  EXPECT_NEAR(test.integral, 1.0, 1e-3);
}

TEST(Environment, constant_samples_match_their_density) {
  const Environment environment = Environment::constant(V3f(1, 2, 3));
  const SamplerTest test = test_sampler(chart_of(environment), 901, 200000);
  EXPECT_GT(test.result.p_value, 0.005) << test.replay;
  EXPECT_NEAR(test.integral, 1.0, 1e-4);
  EXPECT_NEAR(environment.total(), 8.0 * kPi, 1e-9);
}

TEST(Environment, constant_samples_follow_the_cosine_of_a_receiver) {
  const Environment environment = Environment::constant(V3f(1, 2, 3));
  const Receiver at(V3f(0.0f), V3f(0.3f, -0.8f, 0.4f).normalized());
  const SamplerTest test =
      test_sampler(sphere_chart(
                       [&](TestRandom& random) -> std::optional<V3f> {
                         const auto drawn = environment.sample(at, random.next_2d());
                         return drawn ? std::optional(drawn->dir_world) : std::nullopt;
                       },
                       [&](const V3f& w) { return environment.look(w).pdf_solid_angle(at); }),
                   902, 200000);
  EXPECT_GT(test.result.p_value, 0.005) << test.replay;
  EXPECT_NEAR(test.integral, 1.0, 1e-3);
}

/// The irradiance that the choice among lights goes by, against quadrature.
TEST(Environment, knows_about_what_arrives) {
  const auto exact = [](const Environment& environment, const V3f& normal) {
    return integrate(
        [&](const V2d& p) {
          const V3d w(std::cos(p.x) * std::sin(p.y), std::cos(p.y), std::sin(p.x) * std::sin(p.y));
          const V3f radiance = environment.radiance(V3f(w));
          return (radiance.x + radiance.y + radiance.z) / 3.0 * std::max(0.0, w.dot(V3d(normal))) *
                 std::sin(p.y);
        },
        {-kPi, kPi, 0.0, kPi}, 1e-4);
  };
  const Environment even = Environment::constant(V3f(1, 2, 3));
  const Environment image = Environment::image(sky(), 2.0f, 77.0f);
  for (const V3f& direction :
       {V3f(0, 1, 0), V3f(0, -1, 0), V3f(1, 0, 0.2f), V3f(-1, 0.3f, 1), V3f(0, 0.5f, -1)}) {
    const Receiver at(V3f(0.0f), direction.normalized());
    EXPECT_NEAR(even.arriving(at).irradiance, 2.0 * kPi, 1e-6);
    EXPECT_NEAR(even.arriving(at).unevenness, 0.0, 1e-9);
    const double found = image.arriving(at).irradiance;
    EXPECT_NEAR(found, exact(image, at.normal), 0.15 * exact(image, at.normal) + 0.05 * image.total())
        << direction;
    EXPECT_GE(image.arriving(at).unevenness, 0.0);
    EXPECT_LE(image.arriving(at).unevenness, 1.0);
  }
  EXPECT_NEAR(even.arriving(kAnywhere).irradiance, 8.0 * kPi, 1e-6);
  EXPECT_NEAR(even.arriving(kAnywhere).unevenness, 0.0, 1e-9);
}

TEST(Environment, sample_reports_the_density_of_its_direction) {
  for (const float rotation : {0.0f, 77.0f, -200.0f}) {
    const Environment environment = Environment::image(sky(), 1.0f, rotation);
    TestRandom random(3);
    int differ = 0;
    for (int i = 0; i < 10000; ++i) {
      const auto drawn = environment.sample(kAnywhere, random.next_2d());
      ASSERT_TRUE(drawn);
      EXPECT_NEAR(drawn->dir_world.length(), 1.0f, 1e-6f);
      const float pdf = environment.look(drawn->dir_world).pdf_solid_angle(kAnywhere);
      if (std::abs(pdf / drawn->pdf_solid_angle - 1.0f) > 1e-5f) ++differ;  // rounded across a texel's border
    }
    EXPECT_LT(differ, 10) << rotation;
  }
}

/// The estimate of the whole radiance by sampling, which is unbiased only if nothing bright is never drawn.
TEST(Environment, sampling_recovers_the_total_radiance) {
  const Environment environment = Environment::image(sky(), 1.0f, 30.0f);
  const double exact = integrate(
      [&](const V2d& p) {
        const V3d w(std::cos(p.x) * std::sin(p.y), std::cos(p.y), std::sin(p.x) * std::sin(p.y));
        const V3f radiance = environment.radiance(V3f(w));
        return (radiance.x + radiance.y + radiance.z) / 3.0 * std::sin(p.y);
      },
      {-kPi, kPi, 0.0, kPi}, 1e-6);
  TestRandom random(4);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int samples = 100000;
  for (int i = 0; i < samples; ++i) {
    const auto drawn = environment.sample(kAnywhere, random.next_2d());
    const V3f radiance = environment.radiance(drawn->dir_world);
    const double value = (radiance.x + radiance.y + radiance.z) / 3.0 / drawn->pdf_solid_angle;
    sum += value;
    squares += value * value;
  }
  const double mean = sum / samples;
  const double error = std::sqrt((squares / samples - mean * mean) / samples);
  EXPECT_NEAR(mean, exact, 4.0 * error);
  EXPECT_LT(error * std::sqrt(samples), mean) << "importance sampling: less than 100% deviation a sample";
  EXPECT_NEAR(environment.total() / exact, 1.0, 0.05);
}

TEST(Environment, orientation) {
  // One column a quarter: left half of the centre, and so on. The centre of a 4-wide image lies between x = 1
  // and 2.
  Image image(4, 3, 1);
  image.at(2, 1, 0) = 1.0f;  // right of the centre: between -z and +x
  const auto brightest = [&](float rotation) {
    const Environment environment = Environment::image(image, 1.0f, rotation);
    V3f best(0.0f);
    float most = -1.0f;
    for (int i = 0; i < 720; ++i) {
      const double phi = i * kPi / 360.0;
      const V3f w(V3d(std::sin(phi), 0.0, -std::cos(phi)));
      if (environment.radiance(w).x > most) {
        most = environment.radiance(w).x;
        best = w;
      }
    }
    return best;
  };
  const float h = std::sqrt(0.5f);
  EXPECT_LT((brightest(0.0f) - V3f(h, 0, -h)).length(), 1e-2f);
  // Counter-clockwise from above: +x turns towards -z.
  EXPECT_LT((brightest(90.0f) - V3f(-h, 0, -h)).length(), 1e-2f);
  EXPECT_LT((brightest(-45.0f) - V3f(1, 0, 0)).length(), 1e-2f);
  Image top(4, 4, 1);
  for (int x = 0; x < 4; ++x) top.at(x, 0, 0) = 1.0f;
  const Environment up = Environment::image(top, 3.0f, 0.0f);
  EXPECT_FLOAT_EQ(up.radiance(V3f(0, 1, 0)).x, 3.0f);
  EXPECT_EQ(up.radiance(V3f(0, -1, 0)).x, 0.0f);
}

TEST(Environment, reads_bilinearly_and_around_the_seam) {
  Image image(4, 2, 1);
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 2; ++y) image.at(x, y, 0) = static_cast<float>(x);
  }
  const Environment environment = Environment::image(image, 1.0f, 0.0f);
  EXPECT_NEAR(environment.radiance(V3f(0, 0, -1)).x, 1.5f, 1e-6f);
  EXPECT_NEAR(environment.radiance(V3f(0, 0, 1)).x, 1.5f,
              1e-6f);  // halfway between the last column and the first
  EXPECT_NEAR(environment.radiance(V3f(1, 0, 0)).x, 2.5f, 1e-6f);
}

TEST(Environment, black_is_never_sampled) {
  for (const Environment& environment :
       {Environment::constant(V3f(0)), Environment::image(Image(8, 4, 3), 1.0f, 0.0f),
        Environment::image(sky(), 0.0f, 0.0f)}) {
    EXPECT_FALSE(environment.sample(kAnywhere, V2f(0.5f)));
    EXPECT_EQ(environment.look(V3f(0, 1, 0)).pdf_solid_angle(kAnywhere), 0.0f);
    EXPECT_EQ(environment.radiance(V3f(0, 1, 0)), V3f(0.0f));
    EXPECT_EQ(environment.total(), 0.0);
  }
}

TEST(Environment, damaged_values_are_replaced_and_counted) {
  Image image(4, 2, 3, 1.0f);
  image.at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
  image.at(1, 0, 1) = -3.0f;
  image.at(2, 1, 2) = std::numeric_limits<float>::infinity();
  const Environment environment = Environment::image(image, 1.0f, 0.0f);
  EXPECT_EQ(environment.replaced_values(), 3u);
  TestRandom random(2);
  for (int i = 0; i < 1000; ++i) {
    const auto drawn = environment.sample(kAnywhere, random.next_2d());
    ASSERT_TRUE(drawn);
    const V3f radiance = environment.radiance(drawn->dir_world);
    ASSERT_TRUE(is_finite(radiance) && radiance.x >= 0.0f && radiance.z <= 65504.0f) << radiance;
  }
}

TEST(Environment, finite_at_the_extremes) {
  constexpr float last_below_one = 0x1.fffffep-1f;
  Image bright(3, 5, 3, 1e30f);
  Image dim(1, 1, 1, 1e-30f);
  Image tall(1, 16384, 1, 1.0f);
  for (const auto& [image, scale] :
       {std::pair(&bright, 1.0f), std::pair(&bright, 1e10f), std::pair(&dim, 1.0f), std::pair(&tall, 1.0f)}) {
    const Environment environment = Environment::image(*image, scale, 12.0f);
    for (const float ux : {0.0f, 0.5f, last_below_one}) {
      for (const float uy : {0.0f, 1e-7f, 0.5f, last_below_one}) {
        const auto drawn = environment.sample(kAnywhere, V2f(ux, uy));
        ASSERT_TRUE(drawn) << image->height() << " u " << ux << " " << uy;
        EXPECT_NEAR(drawn->dir_world.length(), 1.0f, 1e-6f);
        EXPECT_TRUE(std::isfinite(drawn->pdf_solid_angle) && drawn->pdf_solid_angle > 0.0f);
        EXPECT_TRUE(is_finite(environment.radiance(drawn->dir_world)));
      }
    }
    for (const V3f& pole : {V3f(0, 1, 0), V3f(0, -1, 0), V3f(0, 0, 1), V3f(-0.0f, 0, 1), V3f(1e-30f, 1, 0)}) {
      EXPECT_TRUE(is_finite(environment.radiance(pole))) << pole;
      EXPECT_TRUE(std::isfinite(environment.look(pole).pdf_solid_angle(kAnywhere))) << pole;
    }
  }
}

TEST(Environment, wants_one_or_three_channels) {
  EXPECT_THROW(Environment::image(Image(2, 2, 2), 1.0f, 0.0f), Error);
  EXPECT_THROW(Environment::image(Image(), 1.0f, 0.0f), Error);
  EXPECT_NO_THROW(Environment::image(Image(2, 2, 4), 1.0f, 0.0f));
}

}  // namespace
}  // namespace becalm::tracer
