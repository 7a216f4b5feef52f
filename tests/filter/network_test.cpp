// The smoothing network's passes against the formulas in double, and properties that hold for all weights.
#include "filter/smooth/network.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <vector>

#include "tests/filter/device_fixture.h"
#include "tests/filter/grids.h"
#include "tests/filter/pattern.h"
#include "tests/filter/reference/network.h"
#include "tests/filter/task.h"

namespace becalm::filter::network_test {
namespace {

using reference::Estimate;
using reference::Grid;

struct Sample {
  Sample(int width, int height)
      : pixels(width, height), own_pixels(width, height), features(width, height), own(width, height) {}
  gpu::Extent extent() const { return {pixels.width, pixels.height}; }

  Grid<Estimate> pixels;
  Grid<Estimate> own_pixels;  ///< of the unmerged frame, if `pixels` are merged
  Grid<reference::SmoothFeatures> features;
  Grid<reference::SmoothFeatures> own;  ///< of the unmerged frame, if `features` are merged
  float exposure = 1.7f;
};

/// A textured slope under noise before a wall of another normal and a bit of sky, with fireflies and
/// non-finite pixels.
Sample noisy_sample(int width, int height) {
  Sample sample(width, height);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool wall = y < height / 3 + x / 4;
      reference::SmoothFeatures& f = sample.features.at(x, y);
      for (int c = 0; c < 3; ++c) f[c] = static_cast<float>(pattern(2 * x, 2 * y, 4 + c));
      const bool sky = wall && x > 3 * width / 4;
      f[3] = static_cast<float>(sky ? 2.0 : wall ? 1.4 : 0.4 + 0.01 * y);
      f[wall ? 6 : 5] = sky ? 0.0 : 1.0;
      sample.own.at(x, y) = f;
      for (int c = 0; c < 3; ++c) sample.own.at(x, y)[c] = static_cast<float>(0.9 * f[c] + 0.02 * (x % 3));
      Estimate& e = sample.pixels.at(x, y);
      const double light = wall ? 0.5 : 1.0 + 0.02 * x;
      for (int c = 0; c < 3; ++c) {
        e.color[c] = static_cast<float>(light * (0.1 + f[c]) * std::max(1 + noise(random), 0.0));
      }
      e.color[3] = 1.0;
      e.variance = static_cast<float>(std::pow(0.3 * light * 0.6, 2));
      if ((x * 7 + y * 11) % 97 == 0) {
        for (int c = 0; c < 3; ++c) e.color[c] *= 3000;
        e.variance = static_cast<float>(std::pow(e.color[1], 2));
      }
      e.count = (x * 5 + y * 3) % 41 == 0 ? 0.0 : 1.0;
      sample.own_pixels.at(x, y) = e;
      for (int c = 0; c < 3; ++c) {
        sample.own_pixels.at(x, y).color[c] *= static_cast<float>(std::max(1 + noise(random), 0.0));
      }
    }
  }
  return sample;
}

/// Kinds of frames: merged ones, with albedos of their own; single ones; ones without albedo.
enum class Kind { merged, single, without_albedo };

/// `before`: weights that are used first, if given.
Grid<Estimate> smooth_on(gpu::Device& device, const Sample& sample, const NetworkWeights& weights,
                         bool variance_known = true, std::optional<Convolver> convolver = std::nullopt,
                         Kind kind = Kind::merged, const OwnShareWeights* own_share = &embedded_own_share(),
                         std::optional<int> strip = std::nullopt, const NetworkWeights* before = nullptr) {
  const gpu::Extent extent = sample.extent();
  gpu::Chain chain(device, "network test");
  FilterTask task = task_with_variance(preset("balanced"), extent);
  task.merged = kind == Kind::merged;
  task.used.set(static_cast<std::size_t>(Aov::albedo), kind != Kind::without_albedo);
  for (const Aov aov : {Aov::normal, Aov::depth}) task.used.set(static_cast<std::size_t>(aov));
  const NoisyInputs noisy(chain, task, extent, NoisyUse::smooth);
  const NetworkPasses network(chain, {weights, own_share}, extent, noisy, variance_known, {},
                              convolver.value_or(convolver_of(device.info())), strip);
  const Smoothed& smoothed = network.smoothed();
  chain.output(smoothed.color);
  chain.output(smoothed.stats);
  chain.build();
  chain.upload<float>(noisy.exposure)[0] = sample.exposure;
  const auto upload_features = [&](const Grid<reference::SmoothFeatures>& features,
                                   const SurfaceImages& images) {
    for (std::size_t i = 0; i < features.data.size(); ++i) {
      const reference::SmoothFeatures& f = features.data[i];
      std::copy_n(f.begin(), 4, chain.upload<float>(images.albedo_depth).begin() + 4 * i);
      std::copy_n(f.begin() + 4, 3, chain.upload<float>(images.normal).begin() + 4 * i);
    }
  };
  const auto run_with = [&](const NetworkWeights& used) {
    network.upload_weights(chain, used);
    upload_estimate(chain, noisy.color, noisy.variance, sample.pixels);
    upload_features(sample.features, *noisy.features);
    upload_features(sample.own, *noisy.own_features);
    for (std::size_t i = 0; i < sample.own_pixels.data.size(); ++i) {
      for (int c = 0; c < 4; ++c) {
        chain.upload<float>(noisy.own_color)[4 * i + c] =
            static_cast<float>(sample.own_pixels.data[i].color[c]);
      }
    }
    chain.run();
  };
  if (before) run_with(*before);
  run_with(weights);
  return download_estimate(chain, smoothed.color, smoothed.stats, extent);
}

/// A network with random weights, whose features and windows depend on every input.
NetworkWeights random_weights() {
  NetworkWeights weights = embedded_weights();
  std::mt19937 random(5);
  const auto randomize = [&](Layer& layer, float spread) {
    std::normal_distribution<float> normal(0,
                                           spread / std::sqrt(float(layer.inputs * layer.side * layer.side)));
    for (float& w : layer.weight) w = normal(random);
    for (float& b : layer.bias) b += 0.1f * normal(random);
  };
  for (Layer& layer : weights.encode) randomize(layer, 1.4f);
  for (Layer& layer : weights.decode) randomize(layer, 1.4f);
  for (Layer& layer : weights.window) randomize(layer, 1.5f);
  for (Layer& layer : weights.confidence) randomize(layer, 3.0f);
  randomize(weights.finish, 1.4f);
  randomize(weights.albedo, 1.0f);
  randomize(weights.error, 1.0f);
  return weights;
}

class NetworkTest : public DeviceTest {
 protected:
  /// Compares the results of every convolver that the device supports.
  void expect_agreement(const Sample& sample, const NetworkWeights& weights, bool variance_known) {
    const auto reference_with = [&](const OwnShareWeights* own_share) {
      return reference::smooth_by_network({sample.pixels, sample.own_pixels}, {sample.features, sample.own},
                                          sample.exposure, weights, variance_known, own_share);
    };
    const Grid<Estimate> smoothed = reference_with(nullptr);
    const Grid<Estimate> truth = reference_with(&embedded_own_share());
    double mixed = 0;
    for (std::size_t i = 0; i < truth.data.size(); ++i) {
      mixed += std::abs(truth.data[i].color[1] / smoothed.data[i].color[1] - 1) / truth.data.size();
    }
    EXPECT_GT(mixed, 1e-3) << "the frame itself has hardly a share";
    expect_agreement(sample, truth, smooth_on(device(), sample, weights, variance_known, Convolver::kernels));
    if (!device().info().is_processor) return;
    expect_agreement(sample, truth, smooth_on(device(), sample, weights, variance_known, Convolver::host));
  }

  static void expect_agreement(const Sample& sample, const Grid<Estimate>& truth,
                               const Grid<Estimate>& found) {
    double changed = 0;
    for (int y = 0; y < found.height; ++y) {
      for (int x = 0; x < found.width; ++x) {
        const Estimate& t = truth.at(x, y);
        for (int c = 0; c < 4; ++c) {
          ASSERT_NEAR(found.at(x, y).color[c], t.color[c], 1e-3 * std::abs(t.color[c]))
              << x << ',' << y << " channel " << c;
        }
        if (t.count > 0) {
          ASSERT_NEAR(found.at(x, y).variance, t.variance, 1e-3 * t.variance) << x << ',' << y;
        }
        ASSERT_EQ(found.at(x, y).count, t.count) << x << ',' << y;
        changed += std::abs(t.color[1] / sample.pixels.at(x, y).color[1] - 1) / found.data.size();
      }
    }
    EXPECT_GT(changed, 0.03) << "there was hardly anything to smooth";
  }
};

TEST_F(NetworkTest, AgreesWithTheReference) {
  expect_agreement(noisy_sample(27, 21), random_weights(), true);
  expect_agreement(noisy_sample(17, 30), embedded_weights(), true);
}

TEST_F(NetworkTest, AgreesWithTheReferenceWhereTheVarianceIsUnknown) {
  expect_agreement(noisy_sample(32, 16), random_weights(), false);
}

TEST_F(NetworkTest, AgreesWithTheReferenceForSingleFramesWithAndWithoutAlbedo) {
  Sample sample = noisy_sample(27, 21);
  sample.own = sample.features;
  sample.own_pixels = sample.pixels;
  for (const Kind kind : {Kind::single, Kind::without_albedo}) {
    for (reference::SmoothFeatures& f : sample.features.data) {
      if (kind == Kind::without_albedo) std::fill_n(f.begin(), 3, 1.0);
    }
    sample.own = sample.features;
    const Grid<Estimate> truth =
        reference::smooth_by_network({sample.pixels, sample.own_pixels}, {sample.features, sample.own},
                                     sample.exposure, embedded_weights(), true, nullptr);
    expect_agreement(sample, truth,
                     smooth_on(device(), sample, embedded_weights(), true, Convolver::kernels, kind));
    if (device().info().is_processor) {
      expect_agreement(sample, truth,
                       smooth_on(device(), sample, embedded_weights(), true, Convolver::host, kind));
    }
  }
}

TEST_F(NetworkTest, AgreesWithTheReferenceForAnAlbedo) {
  Sample sample = noisy_sample(27, 21);
  for (reference::SmoothFeatures& f : sample.features.data) std::fill_n(f.begin(), 3, 1.0);
  sample.own = sample.features;
  sample.own_pixels = sample.pixels;
  const Grid<Estimate> truth =
      reference::windows_of_network({sample.pixels, sample.own_pixels}, {sample.features, sample.own},
                                    sample.exposure, embedded_albedo_weights(), false);
  expect_agreement(sample, truth,
                   smooth_on(device(), sample, embedded_albedo_weights(), false, std::nullopt,
                             Kind::without_albedo, nullptr));
}

TEST_F(NetworkTest, OneDnnAndKernelsAgreeForImagesOfAnySize) {
  if (!device().info().is_processor) GTEST_SKIP() << "oneDNN convolves on software devices only";
  for (const gpu::Extent extent : {gpu::Extent{1, 1}, {200, 1}, {1, 70}, {33, 47}}) {
    const Sample sample = noisy_sample(extent.width, extent.height);
    const Grid<Estimate> kernels = smooth_on(device(), sample, random_weights(), true, Convolver::kernels);
    const Grid<Estimate> host = smooth_on(device(), sample, random_weights(), true, Convolver::host);
    for (std::size_t i = 0; i < host.data.size(); ++i) {
      for (int c = 0; c < 4; ++c) {
        ASSERT_NEAR(host.data[i].color[c], kernels.data[i].color[c],
                    1e-3 * std::abs(kernels.data[i].color[c]));
      }
      ASSERT_NEAR(host.data[i].variance, kernels.data[i].variance, 1e-3 * kernels.data[i].variance);
      ASSERT_EQ(host.data[i].count, kernels.data[i].count);
    }
  }
}

TEST_F(NetworkTest, TheNumberOfThreadsDoesNotMatter) {
  const Sample sample = noisy_sample(70, 90);
  const auto colors = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<std::array<double, 4>> values;
    for (const Estimate& e : smooth_on(device(), sample, random_weights()).data) values.push_back(e.color);
    return values;
  };
  EXPECT_EQ(colors(1), colors(3));
}

TEST_F(NetworkTest, ImagesOfOnePixelAndOfOneRowComeOut) {
  for (const gpu::Extent extent : {gpu::Extent{1, 1}, {200, 1}, {1, 70}}) {
    Sample sample = noisy_sample(extent.width, extent.height);
    for (Estimate& e : sample.pixels.data) e.count = 1.0;
    for (const Estimate& e : smooth_on(device(), sample, random_weights()).data) {
      for (const double c : e.color) ASSERT_TRUE(std::isfinite(c));
    }
  }
}

TEST_F(NetworkTest, StripsChangeNothing) {
  for (const gpu::Extent extent : {gpu::Extent{1, 1}, {200, 1}, {1, 70}, {27, 21}}) {
    SCOPED_TRACE(fmt::format("{}x{}", extent.width, extent.height));
    const Sample sample = noisy_sample(extent.width, extent.height);
    const auto with_strips_of = [&](int rows) {
      return smooth_on(device(), sample, random_weights(), true, std::nullopt, Kind::merged,
                       &embedded_own_share(), rows);
    };
    const Grid<Estimate> one = with_strips_of(1);
    for (const int rows : {2, 3}) {
      const Grid<Estimate> result = with_strips_of(rows);
      for (std::size_t i = 0; i < one.data.size(); ++i) {
        ASSERT_EQ(result.data[i].color, one.data[i].color) << rows << " rows, pixel " << i;
        ASSERT_EQ(result.data[i].variance, one.data[i].variance) << rows << " rows, pixel " << i;
      }
    }
  }
}

TEST_F(NetworkTest, OtherWeightsTakeTheirPlaceWhole) {
  const Sample sample = noisy_sample(24, 16);
  const NetworkWeights random = random_weights();
  for (const Convolver convolver : {Convolver::kernels, Convolver::host}) {
    const auto smooth_after = [&](const NetworkWeights* before) {
      return smooth_on(device(), sample, embedded_weights(), true, convolver, Kind::merged,
                       &embedded_own_share(), std::nullopt, before);
    };
    const Grid<Estimate> expected = smooth_after(nullptr);
    const Grid<Estimate> found = smooth_after(&random);
    for (std::size_t i = 0; i < found.data.size(); ++i) {
      ASSERT_EQ(found.data[i].color, expected.data[i].color) << i;
      ASSERT_EQ(found.data[i].variance, expected.data[i].variance) << i;
    }
  }
}

TEST_F(NetworkTest, AnEvenSurfaceStaysAsItIs) {
  Sample sample(40, 24);
  for (Estimate& e : sample.pixels.data) e = {.color = {0.3, 2.0, 5.0, 1.0}, .variance = 0.5, .count = 1.0};
  for (reference::SmoothFeatures& f : sample.features.data) f = {0.5, 0.25, 0.75, 1.0, 0.0, 0.0, 1.0};
  sample.own = sample.features;
  sample.own_pixels = sample.pixels;
  for (const Estimate& e : smooth_on(device(), sample, random_weights()).data) {
    for (int c = 0; c < 4; ++c) ASSERT_NEAR(e.color[c], sample.pixels.data[0].color[c], 2e-6 * e.color[c]);
  }
}

TEST_F(NetworkTest, RadianceScaledByAPowerOfTwoScalesTheResultExactly) {
  const Sample sample = noisy_sample(32, 20);
  Sample scaled = sample;
  constexpr float factor = 1024.0f;
  scaled.exposure /= factor;
  for (Grid<Estimate>* frame : {&scaled.pixels, &scaled.own_pixels}) {
    for (Estimate& e : frame->data) {
      for (int c = 0; c < 3; ++c) e.color[c] *= factor;
      e.variance *= factor * factor;
    }
  }
  const Grid<Estimate> expected = smooth_on(device(), sample, random_weights());
  const Grid<Estimate> found = smooth_on(device(), scaled, random_weights());
  for (std::size_t i = 0; i < found.data.size(); ++i) {
    for (int c = 0; c < 3; ++c) ASSERT_EQ(found.data[i].color[c], factor * expected.data[i].color[c]);
    ASSERT_EQ(found.data[i].variance, factor * factor * expected.data[i].variance);
  }
}

TEST_F(NetworkTest, NothingIsInvented) {
  // Without albedo every channel is a weighted mean of the frame's.
  Sample sample = noisy_sample(40, 24);
  std::array<double, 2> range{1e30, 0.0};
  for (std::size_t i = 0; i < sample.pixels.data.size(); ++i) {
    for (int c = 0; c < 3; ++c) sample.features.data[i][c] = sample.own.data[i][c] = 1.0;
    sample.pixels.data[i].count = 1.0;
    for (const Grid<Estimate>* frame : {&sample.pixels, &sample.own_pixels}) {
      range[0] = std::min(range[0], frame->data[i].color[1]);
      range[1] = std::max(range[1], frame->data[i].color[1]);
    }
  }
  for (const Estimate& e : smooth_on(device(), sample, random_weights()).data) {
    ASSERT_GE(e.color[1], range[0] * (1 - 1e-6));
    ASSERT_LE(e.color[1], range[1] * (1 + 1e-6));
  }
}

/// Layers that tell the same everywhere.
OwnShareWeights constant_share(float logit) {
  OwnShareWeights layers = embedded_own_share();
  std::ranges::fill(layers.back().weight, 0.0f);
  layers.back().bias = {logit};
  return layers;
}

constexpr float kNever = -80.0f;
constexpr float kAlways = 80.0f;

TEST_F(NetworkTest, TheOutputIsTheMeanOfTheMergedFrameAndTheFrameItself) {
  Sample sample = noisy_sample(40, 24);
  for (Estimate& e : sample.pixels.data) e.count = 1.0;
  const auto result_by = [&](float logit) {
    const OwnShareWeights layers = constant_share(logit);
    return smooth_on(device(), sample, embedded_weights(), true, std::nullopt, Kind::merged, &layers);
  };
  const Grid<Estimate> merged = result_by(kNever);
  const Grid<Estimate> half = result_by(0.0f);
  const Grid<Estimate> frame = result_by(kAlways);
  std::size_t outliers = 0;
  for (std::size_t i = 0; i < merged.data.size(); ++i) {
    const double y = merged.data[i].color[1];
    const double x = sample.own_pixels.data[i].color[1];
    const double moved = frame.data[i].color[1] - y;
    ASSERT_NEAR(half.data[i].color[1], y + 0.5 * moved, 1e-5 * (x + y));
    // Only an outlier, which differs more than its patch, is not taken whole.
    if (std::abs(moved - (x - y)) < 1e-4 * (x + y)) continue;
    EXPECT_LT(std::abs(moved), std::abs(x - y));
    ++outliers;
  }
  EXPECT_GT(outliers, 0u);
  EXPECT_LT(outliers, merged.data.size() / 4);
}

TEST_F(NetworkTest, AFireflyOfTheFrameItselfHasHardlyAShare) {
  constexpr int x = 20;
  constexpr int y = 12;
  constexpr float firefly = 1e6f;
  Sample sample = noisy_sample(40, 24);
  for (Estimate& e : sample.pixels.data) e.count = 1.0;
  for (int c = 0; c < 3; ++c) sample.own_pixels.at(x, y).color[c] = firefly;
  const auto color_with_share = [&](float logit) {
    const OwnShareWeights layers = constant_share(logit);
    return smooth_on(device(), sample, embedded_weights(), true, std::nullopt, Kind::merged, &layers)
        .at(x, y)
        .color[1];
  };
  EXPECT_LT(color_with_share(0.0f) - color_with_share(kNever), 1e-4 * firefly);
}

TEST_F(NetworkTest, NoiseBeyondAllThatItHasLearnedCountsAsSomeThatItHas) {
  const OwnShareWeights layers = constant_share(kNever);
  const auto result_with = [&](double variance) {
    Sample sample = noisy_sample(40, 24);
    for (int y = 0; y < sample.pixels.height; ++y) {
      for (int x = y % 3; x < sample.pixels.width; x += 3) sample.pixels.at(x, y).variance = variance;
    }
    return smooth_on(device(), sample, embedded_weights(), true, std::nullopt, Kind::merged, &layers);
  };
  const Grid<Estimate> noisy = result_with(1e18);
  const Grid<Estimate> noisier = result_with(1e26);
  for (std::size_t i = 0; i < noisy.data.size(); ++i)
    EXPECT_NEAR(noisier.data[i].color[1], noisy.data[i].color[1], 1e-3 * noisy.data[i].color[1]) << i;
}

TEST_F(NetworkTest, RadianceAtTheEndsOfFloatComesOutFinite) {
  for (const float scale : {1e-30f, 1e30f}) {
    Sample sample = noisy_sample(40, 24);
    sample.exposure = std::clamp(1.0f / scale, 1e-15f, 1e15f);
    for (Grid<Estimate>* frame : {&sample.pixels, &sample.own_pixels}) {
      for (Estimate& e : frame->data) {
        for (int c = 0; c < 3; ++c) e.color[c] *= scale;
        e.variance = std::min(e.variance * scale * scale, 1e34);
      }
    }
    for (const Estimate& e : smooth_on(device(), sample, random_weights()).data) {
      for (const double c : e.color) ASSERT_TRUE(std::isfinite(c));
      ASSERT_TRUE(std::isfinite(e.variance));
    }
  }
}

}  // namespace
}  // namespace becalm::filter::network_test
