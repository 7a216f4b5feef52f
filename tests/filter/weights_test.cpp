// The networks that are embedded, and those between them.
#include "filter/smooth/weights.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace becalm::filter {
namespace {

TEST(Weights, BetweenTwoNetworksLieTheirMeans) {
  const NetworkWeights& independent = embedded_weights();
  const NetworkWeights& shared = embedded_shared_noise_weights();
  const NetworkWeights middle = between(independent, shared, 0.25f);
  const auto expect_between = [](const Layer& from, const Layer& to, const Layer& found) {
    for (std::size_t i = 0; i < from.weight.size(); ++i)
      ASSERT_NEAR(found.weight[i], 0.75 * from.weight[i] + 0.25 * to.weight[i], 1e-6);
    for (std::size_t i = 0; i < from.bias.size(); ++i)
      ASSERT_NEAR(found.bias[i], 0.75 * from.bias[i] + 0.25 * to.bias[i], 1e-6);
    EXPECT_NE(found.weight, from.weight);
  };
  for (std::size_t i = 0; i < kScales; ++i) {
    expect_between(independent.encode[i], shared.encode[i], middle.encode[i]);
    expect_between(independent.window[i], shared.window[i], middle.window[i]);
    expect_between(independent.confidence[i], shared.confidence[i], middle.confidence[i]);
  }
  for (std::size_t i = 0; i + 1 < kScales; ++i)
    expect_between(independent.decode[i], shared.decode[i], middle.decode[i]);
  expect_between(independent.finish, shared.finish, middle.finish);
  expect_between(independent.albedo, shared.albedo, middle.albedo);
  expect_between(independent.error, shared.error, middle.error);
}

}  // namespace
}  // namespace becalm::filter
