#include "tracer/media/homogeneous_medium.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tracer/media/test_media.h"
#include "tracer/media/medium.h"

namespace becalm::tracer {
namespace {

TEST(HomogeneousMedium, TransmittanceIsBeersLaw) {
  const HomogeneousMedium medium{V3f(0.5f, 2.0f, 0.0f), V3f(0.5f), 0.0f};
  const V3f passed = transmittance(medium, 3.0f);
  EXPECT_FLOAT_EQ(passed.x, std::exp(-1.5f));
  EXPECT_FLOAT_EQ(passed.y, std::exp(-6.0f));
  EXPECT_EQ(passed.z, 1.0f);
  EXPECT_EQ(transmittance(medium, 0.0f), V3f(1.0f));
  EXPECT_EQ(transmittance(medium, kInfinity), V3f(0.0f, 0.0f, 1.0f));
}

/// The samples that scatter in each of these bins, weighted, are an estimate of the integral of
/// transmittance * scattering coefficient over it, for each channel; those that do not, of the transmittance.
TEST(HomogeneousMedium, WeightedDistancesEstimateTransmittanceAndScattering) {
  const HomogeneousMedium medium{V3f(0.2f, 1.5f, 6.0f), V3f(0.9f, 0.3f, 0.6f), 0.0f};
  constexpr float t_max = 1.3f;
  constexpr int bins = 8;
  const V3f throughputs[] = {V3f(1.0f), V3f(0.1f, 3.0f, 0.5f), V3f(0.0f, 0.0f, 2.0f), V3f(1e-30f),
                             V3f(1e30f)};
  const double level = sidak_level(0.01, 5 * 3 * (bins + 1));
  for (const V3f& throughput : throughputs) {
    TestRandom random(21);
    MeanTest estimates[bins + 1][3];
    for (int i = 0; i < 60000; ++i) {
      MediumRandom tracking = medium_random(random);
      const MediumSample sample = sample_distance(medium, t_max, tracking, throughput);
      const int bin = sample.scattered ? static_cast<int>(sample.t / t_max * bins) : bins;
      for (int b = 0; b <= bins; ++b) {
        for (int c = 0; c < 3; ++c) estimates[b][c].add(b == bin ? sample.weight[c] : 0.0);
      }
    }
    for (int c = 0; c < 3; ++c) {
      if (throughput[c] == 0.0f) continue;  // a channel that carries nothing need not be estimated
      const auto passed = [&](double t) { return std::exp(-double{medium.extinction[c]} * t); };
      for (int b = 0; b <= bins; ++b) {
        const double truth = b == bins ? passed(t_max)
                                       : medium.albedo[c] * (passed(t_max * double(b) / bins) -
                                                             passed(t_max * double(b + 1) / bins));
        EXPECT_GT(estimates[b][c].p_value(truth), level)
            << "bin " << b << " channel " << c << " throughput " << throughput << ": "
            << estimates[b][c].mean() << " for " << truth << ", seed 21";
      }
    }
  }
}

TEST(HomogeneousMedium, GreyWeightsAreExact) {
  const HomogeneousMedium medium{V3f(1.0f), V3f(0.7f), 0.0f};
  TestRandom random(22);
  for (int i = 0; i < 1000; ++i) {
    MediumRandom tracking = medium_random(random);
    const MediumSample sample = sample_distance(medium, 1.0f, tracking, V3f(1.0f, 0.5f, 0.25f));
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(sample.weight[c], sample.scattered ? 0.7f : 1.0f, 1e-6f);
  }
}

TEST(HomogeneousMedium, WeightsAreBounded) {
  const HomogeneousMedium medium{V3f(1e-3f, 1.0f, 100.0f), V3f(1.0f, 0.5f, 0.0f), 0.0f};
  TestRandom random(23);
  for (int i = 0; i < 100000; ++i) {
    const V3f throughput(random.next() + 1e-3f, random.next() + 1e-3f, random.next() + 1e-3f);
    MediumRandom tracking = medium_random(random);
    const MediumSample sample = sample_distance(medium, 20.0f * random.next(), tracking, throughput);
    const float sum = throughput.x + throughput.y + throughput.z;
    ASSERT_LE(max_component(throughput * sample.weight), sum * 1.0001f);
  }
}

TEST(HomogeneousMedium, AbsorptionAloneHasNoNoise) {
  const HomogeneousMedium medium{V3f(0.5f, 1.0f, 2.0f), V3f(0.0f), 0.0f};
  TestRandom random(24);
  MediumRandom tracking = medium_random(random);
  const MediumSample sample = sample_distance(medium, 2.0f, tracking, V3f(1.0f));
  EXPECT_FALSE(sample.scattered);
  EXPECT_EQ(sample.t, 2.0f);
  EXPECT_EQ(sample.weight, transmittance(medium, 2.0f));
}

TEST(HomogeneousMedium, ExtremesGiveFiniteResults) {
  const float extinctions[] = {0.0f, 1e-30f, 1e-3f, 1.0f, 1e30f};
  const float distances[] = {0.0f, 1e-30f, 1.0f, 1e30f, kInfinity};
  const V3f throughputs[] = {V3f(1.0f), V3f(0.0f), V3f(1e30f, 1e-30f, 0.0f), V3f(kInfinity, 1.0f, NAN)};
  TestRandom random(25);
  for (const float red : extinctions) {
    for (const float green : extinctions) {
      for (const float t_max : distances) {
        for (const V3f& throughput : throughputs) {
          const HomogeneousMedium medium{V3f(red, green, 1.0f), V3f(1.0f, 0.5f, 0.2f), 0.0f};
          ASSERT_TRUE(is_finite(transmittance(medium, t_max)));
          for (int i = 0; i < 200; ++i) {
            MediumRandom tracking(i == 0 ? V2f(0.0f) : i == 1 ? V2f(1.0f - 0x1p-24f) : random.next_2d());
            const MediumSample sample = sample_distance(medium, t_max, tracking, throughput);
            ASSERT_TRUE(is_finite(sample.weight)) << red << " " << green << " " << t_max << " " << throughput;
            ASSERT_GE(std::min({sample.weight.x, sample.weight.y, sample.weight.z}), 0.0f);
            ASSERT_TRUE(sample.scattered ? sample.t < t_max : sample.t == t_max);
          }
        }
      }
    }
  }
}

TEST(HomogeneousMedium, NoExtinctionNeverScatters) {
  const Medium medium = HomogeneousMedium{V3f(0.0f), V3f(1.0f), 0.0f};
  TestRandom random(26);
  for (const float t_max : {0.0f, 1.0f, kInfinity}) {
    MediumRandom tracking = medium_random(random);
    const MediumSample sample = sample_distance(medium, V3f(0.0f), V3f(0, 0, 1), t_max, tracking, V3f(1.0f));
    EXPECT_FALSE(sample.scattered);
    EXPECT_EQ(sample.weight, V3f(1.0f));
  }
}

}  // namespace
}  // namespace becalm::tracer
