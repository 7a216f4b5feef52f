// Random walks through plane-parallel slabs against what transfer theory knows of them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "tests/tracer/media/test_media.h"
#include "tracer/media/medium.h"

namespace becalm::tracer {
namespace {

struct Slab {
  Medium medium;
  float thickness;  ///< from z = 0 down to z = -thickness; may be infinite
};

struct Passage {
  V3f reflected{0.0f};
  V3f transmitted{0.0f};
};

/// One path that enters from above with the cosine mu0, followed until it leaves; without a surface, light
/// comes in and goes out undisturbed.
Passage walk(const Slab& slab, float mu0, TestRandom& random) {
  V3f position(0.0f);
  V3f dir(std::sqrt(1.0f - mu0 * mu0), 0.0f, -mu0);
  V3f throughput(1.0f);
  MediumRandom tracking = medium_random(random);
  for (;;) {
    const float exit = dir.z > 0.0f   ? -position.z / dir.z
                       : dir.z < 0.0f ? (position.z + slab.thickness) / -dir.z
                                      : std::numeric_limits<float>::infinity();
    const MediumSample sample = sample_distance(slab.medium, position, dir, exit, tracking, throughput);
    throughput *= sample.weight;
    if (!sample.scattered)
      return dir.z > 0.0f ? Passage{throughput, V3f(0.0f)} : Passage{V3f(0.0f), throughput};
    if (max_component(throughput) < 0.1f) {
      if (tracking.next() >= 0.5f) return {};
      throughput *= 2.0f;
    }
    position += dir * sample.t;
    const float u = tracking.next();
    dir = sample_henyey_greenstein(mean_cosine(slab.medium), -dir, V2f(u, tracking.next())).wi;
  }
}

/// Chandrasekhar's H function of isotropic scattering (Radiative Transfer, 1950, chapter V), by fixed-point
/// iteration of 1/H(mu) = sqrt(1 - albedo) + albedo/2 int_0^1 nu H(nu) / (mu + nu) dnu.
class ChandrasekharH {
 public:
  explicit ChandrasekharH(double albedo) : albedo_(albedo), values_(kNodes, 1.0) {
    for (int iteration = 0; iteration < 60; ++iteration) {
      std::vector<double> improved(kNodes);
      for (int i = 0; i < kNodes; ++i) improved[i] = (*this)((i + 0.5) / kNodes);
      values_ = std::move(improved);
    }
  }

  double operator()(double mu) const {
    double integral = 0.0;
    for (int i = 0; i < kNodes; ++i) {
      const double nu = (i + 0.5) / kNodes;
      integral += nu * values_[i] / (mu + nu) / kNodes;
    }
    return 1.0 / (std::sqrt(1.0 - albedo_) + 0.5 * albedo_ * integral);
  }

  double integral() const { return std::accumulate(values_.begin(), values_.end(), 0.0) / kNodes; }

 private:
  static constexpr int kNodes = 200;
  double albedo_;
  std::vector<double> values_;
};

TEST(Slab, SemiInfiniteReflectsAsChandrasekharSays) {
  const V3f albedo(0.3f, 0.6f, 0.9f);
  const Slab slab{HomogeneousMedium{V3f(1.0f, 2.0f, 0.5f), albedo, 0.0f},
                  std::numeric_limits<float>::infinity()};
  const ChandrasekharH h[] = {ChandrasekharH(albedo.x), ChandrasekharH(albedo.y), ChandrasekharH(albedo.z)};
  for (int c = 0; c < 3; ++c) {
    // The integral of H has a closed form.
    const double truth = 2.0 / albedo[c] * (1.0 - std::sqrt(1.0 - double{albedo[c]}));
    ASSERT_NEAR(h[c].integral(), truth, 1e-4) << "albedo " << albedo[c];
  }
  const double level = sidak_level(0.01, 6);
  for (const float mu0 : {1.0f, 0.3f}) {
    TestRandom random(50);
    MeanTest reflected[3];
    for (int i = 0; i < 50000; ++i) {
      const Passage passage = walk(slab, mu0, random);
      for (int c = 0; c < 3; ++c) reflected[c].add(passage.reflected[c]);
    }
    for (int c = 0; c < 3; ++c) {
      const double truth = 1.0 - std::sqrt(1.0 - double{albedo[c]}) * h[c](mu0);
      EXPECT_GT(reflected[c].p_value(truth), level) << "albedo " << albedo[c] << " mu0 " << mu0 << ": "
                                                    << reflected[c].mean() << " for " << truth << ", seed 50";
    }
  }
}

TEST(Slab, PureScatteringLosesNothing) {
  const Slab slab{HomogeneousMedium{V3f(0.5f, 2.0f, 5.0f), V3f(1.0f), 0.6f}, 2.0f};
  TestRandom random(51);
  MeanTest total[3];
  for (int i = 0; i < 20000; ++i) {
    const Passage passage = walk(slab, 0.8f, random);
    for (int c = 0; c < 3; ++c) total[c].add(passage.reflected[c] + passage.transmitted[c]);
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(total[c].p_value(1.0), sidak_level(0.01, 3)) << "channel " << c << ": " << total[c].mean();
    EXPECT_GT(total[c].standard_error(), 0.0);  // the channels' weights differ, so that the sum could
  }
}

TEST(Slab, ThinSlabScattersOnce) {
  // First order in the depth: half of what scatters isotropically leaves through the top.
  constexpr float depth = 1e-3f;
  const Slab slab{HomogeneousMedium{V3f(1.0f), V3f(0.8f), 0.0f}, depth};
  TestRandom random(52);
  MeanTest reflected;
  for (int i = 0; i < 1000000; ++i) reflected.add(walk(slab, 1.0f, random).reflected.x);
  EXPECT_GT(reflected.p_value(0.5 * 0.8 * depth), 1e-3) << reflected.mean();
}

TEST(Slab, SimilarityRelationHoldsForNarrowLobes) {
  // A thick slab of mean cosine g transmits about what an isotropic one of (1 - g) times the depth does.
  const auto transmitted = [](float depth, float g) {
    const Slab slab{HomogeneousMedium{V3f(depth), V3f(1.0f), g}, 1.0f};
    TestRandom random(53);
    double sum = 0.0;
    constexpr int samples = 4000;
    for (int i = 0; i < samples; ++i) sum += walk(slab, 1.0f, random).transmitted.x;
    return sum / samples;
  };
  const double isotropic = transmitted(9.0f, 0.0f);
  EXPECT_NEAR(transmitted(300.0f, 0.97f), isotropic, 0.12 * isotropic);
  // What diffusion says of isotropic scattering and light at normal incidence (extrapolation length 0.7104).
  EXPECT_NEAR(isotropic, (1.0 + 0.7104) / (9.0 + 2.0 * 0.7104), 0.015);
}

}  // namespace
}  // namespace becalm::tracer
