#include "tracer/sampling/discrete_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

TEST(DiscreteDistribution, chooses_by_weight) {
  const std::vector<double> weights = {1.0, 0.0, 3.0, 0.5, 2.5, 0.0};
  const DiscreteDistribution distribution(weights);
  std::vector<double> observed(weights.size(), 0.0);
  const std::vector<double> expected = {50000 / 7.0, 0.0, 150000 / 7.0, 25000 / 7.0, 125000 / 7.0, 0.0};
  TestRandom random(3);
  for (int i = 0; i < 50000; ++i) {
    const auto choice = distribution.sample(random.next());
    observed[choice.index] += 1.0;
    ASSERT_GE(choice.u, 0.0f);
    ASSERT_LT(choice.u, 1.0f);
    ASSERT_EQ(choice.probability, distribution.probability(choice.index));
  }
  EXPECT_GT(chi_square(observed, expected).p_value, 0.01);
  EXPECT_EQ(observed[1] + observed[5], 0.0);
}

TEST(DiscreteDistribution, passes_on_where_u_fell) {
  const DiscreteDistribution distribution(std::vector<double>{1.0, 1.0, 2.0});
  const auto choice = distribution.sample(0.625f);
  EXPECT_EQ(choice.index, 2u);
  EXPECT_FLOAT_EQ(choice.u, 0.25f);
}

TEST(DiscreteDistribution, never_chooses_unusable_weights) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const DiscreteDistribution distribution(std::vector<double>{0.0, nan, 1e300, -1.0, 1e300, inf, 0.0});
  for (const float u : {0.0f, 0.25f, 0.5f, 0.75f, 0x1.fffffep-1f, 1.0f}) {
    const std::size_t index = distribution.sample(u).index;
    EXPECT_TRUE(index == 2 || index == 4) << "u " << u << " index " << index;
    EXPECT_FLOAT_EQ(distribution.sample(u).probability, 0.5f);
  }
  EXPECT_TRUE(DiscreteDistribution(std::vector<double>{0.0, nan, inf}).empty());
  EXPECT_TRUE(DiscreteDistribution(std::vector<double>{}).empty());
  EXPECT_EQ(DiscreteDistribution(std::vector<double>{0.0}).probability(0), 0.0f);
}

}  // namespace
}  // namespace becalm::tracer
