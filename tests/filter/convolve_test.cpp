// The convolutions and the pooling of shaders/smooth/ against plain loops in double: every layer shape of the
// networks, on sizes that are no multiple of a block or workgroup.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/smooth/convolution.h"
#include "shaders/shared/convolve_params.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/layer_shapes.h"
#include "tests/filter/random_values.h"

namespace becalm {
namespace {

using filter::Layer;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

int planes_of(int channels) {
  return channels / filter::kPlane;
}

Extent half(Extent size) {
  return {(size.width + 1) / 2, (size.height + 1) / 2};
}

/// Channel `c` of an image of planes of four channels, its border repeated.
double pixel(std::span<const float> image, Extent size, int c, int x, int y) {
  const int column = std::clamp(x, 0, size.width - 1);
  const int row = std::clamp(y, 0, size.height - 1);
  return image[static_cast<std::size_t>(4 * ((c / 4 * size.height + row) * size.width + column) + c % 4)];
}

class ConvolveTest : public DeviceTest {
 protected:
  /// Runs a layer with random weights and images, `coarse` of whose channels are those of an image of half
  /// the size. Compares every value to within a millionth of the sum of its terms' magnitudes.
  static void expect_matches(int coarse, int fine, int outputs, Extent size) {
    SCOPED_TRACE(std::to_string(coarse) + " + " + std::to_string(fine) + " to " + std::to_string(outputs) +
                 ", " + std::to_string(size.width) + "x" + std::to_string(size.height));
    Layer layer{.inputs = coarse + fine, .outputs = outputs, .side = 3, .weight = {}, .bias = {}};
    layer.weight = random_values(static_cast<std::size_t>(outputs * layer.inputs * 9), 1);
    layer.bias = random_values(static_cast<std::size_t>(outputs), 2);
    const filter::Convolution convolution(layer, coarse);

    gpu::Chain chain(device(), "layer");
    const ImageId source = chain.input("source", Format::f32x4, size.with_planes(planes_of(fine)));
    const ImageId half_source =
        coarse > 0 ? chain.input("coarse", Format::f32x4, half(size).with_planes(planes_of(coarse))) : source;
    const int vectors = static_cast<int>(convolution.weights().size()) / filter::kPlane;
    const ImageId weights = chain.input("weights", Format::f32x4, {vectors, 1});
    const ImageId result = convolution.add_passes(chain, "result", size, weights, source, half_source);
    chain.output(result);
    chain.build();
    const auto values = random_values(size.elements() * static_cast<std::size_t>(fine), 3);
    const auto coarse_values = random_values(half(size).elements() * static_cast<std::size_t>(coarse), 4);
    std::ranges::copy(values, chain.upload<float>(source).begin());
    if (coarse > 0) std::ranges::copy(coarse_values, chain.upload<float>(half_source).begin());
    std::ranges::copy(convolution.weights(), chain.upload<float>(weights).begin());
    chain.run();
    const auto made = chain.download<float>(result);

    double worst = 0.0;
    for (int o = 0; o < outputs; ++o) {
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          double sum = layer.bias[static_cast<std::size_t>(o)];
          double magnitude = std::abs(sum) + 1e-6;
          for (int i = 0; i < layer.inputs; ++i) {
            for (int t = 0; t < 9; ++t) {
              const int column = std::clamp(x + t % 3 - 1, 0, size.width - 1);
              const int row = std::clamp(y + t / 3 - 1, 0, size.height - 1);
              const double value = i < coarse ? pixel(coarse_values, half(size), i, column / 2, row / 2)
                                              : pixel(values, size, i - coarse, column, row);
              sum += layer.at(o, i, t / 3, t % 3) * value;
              magnitude += std::abs(layer.at(o, i, t / 3, t % 3) * value);
            }
          }
          worst = std::max(worst, std::abs(std::max(sum, 0.0) - pixel(made, size, o, x, y)) / magnitude);
        }
      }
    }
    EXPECT_LT(worst, 1e-6);
  }
};

TEST_F(ConvolveTest, MatchesALoopForEveryLayerOfTheNetworks) {
  for (const LayerShape& shape : convolution_shapes()) {
    expect_matches(shape.coarse, shape.fine, shape.outputs, {37, 11});
  }
}

TEST_F(ConvolveTest, MatchesALoopForImagesOfAnySize) {
  for (const Extent size : {Extent{1, 1}, {2, 1}, {1, 2}, {3, 3}, {64, 4}, {65, 5}, {130, 9}, {8, 34}}) {
    expect_matches(0, 8, 8, size);
    expect_matches(8, 8, 8, size);
  }
}

TEST_F(ConvolveTest, PoolsTheLargestOfFourPixels) {
  for (const Extent size : {Extent{2, 2}, {70, 10}, {7, 5}, {1, 1}}) {
    gpu::Chain chain(device(), "pool");
    const ImageId fine = chain.input("fine", Format::f32x4, size.with_planes(3));
    const ImageId coarse = chain.image("coarse", Format::f32x4, half(size).with_planes(3));
    chain.pass("smooth/pool").read("fine", fine).write("coarse", coarse).dispatch(half(size).with_planes(3));
    chain.output(coarse);
    chain.build();
    const auto values = random_values(size.elements() * 12, 5);
    std::ranges::copy(values, chain.upload<float>(fine).begin());
    chain.run();
    const auto made = chain.download<float>(coarse);
    for (int c = 0; c < 12; ++c) {
      for (int y = 0; y < half(size).height; ++y) {
        for (int x = 0; x < half(size).width; ++x) {
          double largest = -2.0;
          for (int i = 0; i < 4; ++i)
            largest = std::max(largest, pixel(values, size, c, 2 * x + i % 2, 2 * y + i / 2));
          ASSERT_EQ(pixel(made, half(size), c, x, y), largest)
              << size.width << "x" << size.height << " " << x << " " << y;
        }
      }
    }
  }
}

}  // namespace
}  // namespace becalm
