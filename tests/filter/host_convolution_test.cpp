// oneDNN's convolutions, row by row, against plain loops in double: every layer shape of the networks, and
// independence of height and thread.
#include "filter/smooth/host_convolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "tests/filter/layer_shapes.h"
#include "tests/filter/random_values.h"

extern "C" void omp_set_num_threads(int threads);
extern "C" int omp_get_max_threads();

namespace becalm::filter::host_convolution_test {
namespace {

/// Random pixels in a frame that repeats the border.
struct FramedImage {
  FramedImage(int channels, int width, int height, std::uint32_t seed)
      : channels(channels), width(width), height(height) {
    const std::vector<float> pixels = random_values(channels * width * height, seed);
    for (int y = -1; y <= height; ++y) {
      for (int x = -1; x <= width; ++x) {
        const int from = std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1);
        for (int c = 0; c < channels; ++c) values.push_back(pixels[from * channels + c]);
      }
    }
  }
  double at(int c, int x, int y) const {
    return values[static_cast<std::size_t>(((y + 1) * (width + 2) + x + 1) * channels + c)];
  }

  int channels, width, height;
  std::vector<float> values;
};

Layer random_layer(int inputs, int outputs) {
  return {.inputs = inputs,
          .outputs = outputs,
          .side = 3,
          .weight = random_values(inputs * outputs * 9, 1),
          .bias = random_values(outputs, 2)};
}

/// Compares every value to within a millionth of the sum of its terms' magnitudes.
void expect_matches(int upsampled, int direct, int outputs, int width, int height) {
  SCOPED_TRACE(std::to_string(upsampled) + " + " + std::to_string(direct) + " to " + std::to_string(outputs) +
               ", " + std::to_string(width) + "x" + std::to_string(height));
  const Layer layer = random_layer(upsampled + direct, outputs);
  const FramedImage source(direct, width, height, 3);
  const FramedImage coarse(upsampled, width / 2, height / 2, 4);
  const HostConvolution convolution(layer, upsampled, width);
  std::vector<float> row(static_cast<std::size_t>((width + 2) * outputs));
  double worst = 0.0;
  HostConvolution::Rows rows(convolution);
  for (int y = 0; y < height; ++y) {
    rows.make(y, source.values.data(), coarse.values.data(), row.data());
    for (int x = 0; x < width; ++x) {
      for (int o = 0; o < outputs; ++o) {
        double sum = layer.bias[static_cast<std::size_t>(o)];
        double magnitude = std::abs(sum) + 1e-6;
        for (int i = 0; i < layer.inputs; ++i) {
          for (int t = 0; t < 9; ++t) {
            const int column = std::clamp(x + t % 3 - 1, 0, width - 1);
            const int line = std::clamp(y + t / 3 - 1, 0, height - 1);
            const double value =
                i < upsampled ? coarse.at(i, column / 2, line / 2) : source.at(i - upsampled, column, line);
            sum += layer.at(o, i, t / 3, t % 3) * value;
            magnitude += std::abs(layer.at(o, i, t / 3, t % 3) * value);
          }
        }
        worst = std::max(worst, std::abs(std::max(sum, 0.0) - row[(x + 1) * outputs + o]) / magnitude);
      }
    }
  }
  EXPECT_LT(worst, 1e-6);
}

TEST(HostConvolution, MatchesALoopForEveryLayer) {
  for (const LayerShape& shape : convolution_shapes()) {
    const bool is_decoder = shape.coarse > 0;
    expect_matches(shape.coarse, shape.fine, shape.outputs, is_decoder ? 38 : 37, is_decoder ? 6 : 5);
  }
}

TEST(HostConvolution, MatchesALoopForImagesOfAnySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 2}, {3, 3}, {65, 4}, {200, 2}}) {
    expect_matches(0, 8, 8, width, height);
  }
  for (const auto& [width, height] : {std::pair{2, 2}, {4, 2}, {2, 4}, {66, 6}}) {
    expect_matches(8, 8, 8, width, height);
  }
}

TEST(HostConvolution, LeavesTheCallersNumberOfThreads) {
  omp_set_num_threads(3);
  const HostConvolution convolution(random_layer(8, 8), 0, 5);
  EXPECT_EQ(omp_get_max_threads(), 3);
  const FramedImage source(8, 5, 1, 3);
  std::vector<float> row(7 * 8);
  HostConvolution::Rows(convolution).make(0, source.values.data(), nullptr, row.data());
  EXPECT_EQ(omp_get_max_threads(), 3);
}

TEST(HostConvolution, MakesTheSameRowsByManyThreads) {
  constexpr int kWidth = 90;
  constexpr int kHeight = 32;
  constexpr int kThreads = 4;
  const FramedImage source(16, kWidth, kHeight, 3);
  const FramedImage coarse(24, kWidth / 2, kHeight / 2, 4);
  const HostConvolution convolution(random_layer(40, 16), 24, kWidth);
  using Rows = std::vector<std::vector<float>>;
  const auto make_rows = [&](int first, int step, Rows& rows) {
    HostConvolution::Rows made(convolution);
    for (int y = first; y < kHeight; y += step) {
      made.make(y, source.values.data(), coarse.values.data(), rows[y].data());
    }
  };
  Rows expected(kHeight, std::vector<float>((kWidth + 2) * 16));
  Rows found = expected;
  make_rows(0, 1, expected);
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) threads.emplace_back(make_rows, t, kThreads, std::ref(found));
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace becalm::filter::host_convolution_test
