// The networks that are embedded, and those between them.
#include "filter/smooth/weights.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "tests/filter/random_values.h"

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

TEST(Weights, OfASingleFrameMakeTheSameOfInputsThatRepeatOthers) {
  std::vector<float> inputs = random_values(kSingleFrameInputs, 1);
  const float grey = (inputs[0] + inputs[1] + inputs[2]) / 3.0f;
  for (int feature = 3; feature < 10; ++feature) inputs.push_back(inputs[feature]);
  inputs.push_back(grey);
  ASSERT_EQ(inputs.size(), std::size_t{kNetworkInputs});
  const Layer& all = embedded_weights().encode[0];
  const Layer single = of_single_frame(embedded_weights()).encode[0];
  ASSERT_EQ(single.inputs, kSingleFrameInputs);
  EXPECT_EQ(single.bias, all.bias);
  const auto sum = [&](const Layer& layer, int output, int tap) {
    double total = 0.0;
    for (int i = 0; i < layer.inputs; ++i) total += layer.at(output, i, tap / 3, tap % 3) * inputs[i];
    return total;
  };
  for (int output = 0; output < all.outputs; ++output) {
    for (int tap = 0; tap < 9; ++tap) ASSERT_NEAR(sum(single, output, tap), sum(all, output, tap), 1e-5);
  }
}

}  // namespace
}  // namespace becalm::filter
