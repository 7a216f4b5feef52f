// The variance estimate for frames without a variance: against the formulas in double, and against known
// noise.
#include "filter/input/estimate_variance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "tests/filter/device_fixture.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
namespace {

using reference::Grid;

struct Pixel {
  std::array<double, 3> color{};
  bool finite = true;
  std::array<double, 4> albedo_depth{1, 1, 1, 0};
  std::array<double, 3> normal{};
};

constexpr float kExposure = 0.5f;
constexpr int kUnknowns = 10;  // value at the pixel, then slopes along albedo, depth, normal and position

double divisor(const Pixel& pixel, std::size_t c) {
  return std::max(pixel.albedo_depth[c], 0.04);
}

/// Solves by elimination with partial pivoting.
std::vector<double> solve(std::vector<std::vector<double>> m, std::vector<double> right) {
  const std::size_t n = right.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c; r < n; ++r) {
      if (std::abs(m[r][c]) > std::abs(m[pivot][c])) pivot = r;
    }
    std::swap(m[c], m[pivot]);
    std::swap(right[c], right[pivot]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      const double share = m[r][c] / m[c][c];
      for (std::size_t k = 0; k < n; ++k) m[r][k] -= share * m[c][k];
      right[r] -= share * right[c];
    }
  }
  for (std::size_t r = 0; r < n; ++r) right[r] /= m[r][r];
  return right;
}

/// A pixel's estimate: a least-squares fit of features for the value at the pixel (shaders/merge/README.md).
double reference_estimate(const Grid<Pixel>& frame, int x, int y) {
  const Pixel& here = frame.at(x, y);
  std::vector<std::array<double, kUnknowns>> rows;
  std::vector<double> weights;
  std::vector<const Pixel*> taps;
  std::size_t own = 0;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      if (x + i < 0 || y + j < 0 || x + i >= frame.width || y + j >= frame.height) continue;
      const Pixel& tap = frame.at(x + i, y + j);
      if (i == 0 && j == 0) own = taps.size();
      std::array<double, kUnknowns> row{1};
      double distance = 0;
      for (std::size_t f = 0; f < 4; ++f) row[1 + f] = tap.albedo_depth[f] - here.albedo_depth[f];
      for (std::size_t f = 0; f < 3; ++f) row[5 + f] = tap.normal[f] - here.normal[f];
      for (std::size_t f = 1; f < 8; ++f) distance += row[f] * row[f];
      row[8] = 0.5 * i;
      row[9] = 0.5 * j;
      rows.push_back(row);
      weights.push_back(tap.finite ? std::max(std::exp(-distance / 0.18), 0.02) : 0.0);
      taps.push_back(&tap);
    }
  }
  double sum = 0;
  for (const double w : weights) sum += w;
  std::vector<std::vector<double>> m(kUnknowns, std::vector<double>(kUnknowns, 0.0));
  for (int r = 0; r < kUnknowns; ++r) {
    for (std::size_t t = 0; t < rows.size(); ++t) {
      for (int s = 0; s < kUnknowns; ++s) m[r][s] += weights[t] * rows[t][r] * rows[t][s];
    }
    if (r > 0) m[r][r] += 0.01 * sum;
  }
  // The fit's residual at the pixel is linear in the values; `part` is its response to one of them.
  std::array<double, 3> left{};
  double noise_left = 0;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    std::vector<double> right(kUnknowns);
    for (int r = 0; r < kUnknowns; ++r) right[r] = weights[t] * rows[t][r];
    const double part = (t == own ? 1.0 : 0.0) - solve(m, right)[0];
    noise_left += part * part;
    for (std::size_t c = 0; c < 3; ++c) left[c] += part * taps[t]->color[c] / divisor(*taps[t], c);
  }
  double squares = 0;
  for (std::size_t c = 0; c < 3; ++c) squares += std::pow(left[c] * divisor(here, c), 2) / 3;
  return squares / std::max(noise_left, 1e-4);
}

/// The estimate without albedo: the second difference along both axes, of the nearest nine pixels inside the
/// image.
double reference_second_difference(const Grid<Pixel>& frame, int x, int y) {
  constexpr std::array<double, 3> coefficient{1, -2, 1};
  const int left = std::clamp(x - 1, 0, frame.width - 3);
  const int top = std::clamp(y - 1, 0, frame.height - 3);
  double squares = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    double difference = 0;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        const Pixel& tap = frame.at(left + i, top + j);
        difference += coefficient.at(i) * coefficient.at(j) * tap.color[c];
      }
    }
    squares += difference * difference / 3;
  }
  return squares / 36;
}

enum class KnowsAlbedo { no, yes };

/// The squared second difference along both axes of taps so far apart, of the radiance without albedo. Taps
/// beyond the border are those at it.
double squared_difference(const Grid<Pixel>& frame, KnowsAlbedo knows_albedo, int x, int y, int distance) {
  constexpr std::array<double, 3> coefficient{1, -2, 1};
  double squares = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    double difference = 0;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        const Pixel& tap = frame.at(std::clamp(x + (i - 1) * distance, 0, frame.width - 1),
                                    std::clamp(y + (j - 1) * distance, 0, frame.height - 1));
        const double by = knows_albedo == KnowsAlbedo::yes ? divisor(tap, c) : 1.0;
        difference += coefficient.at(i) * coefficient.at(j) * tap.color[c] / by;
      }
    }
    squares += difference * difference / 3;
  }
  return squares;
}

/// The share of an estimate that is noise, in a patch of 7x7 without the pixel itself; inside of the frame
/// alone, where no tap is beyond a border.
double reference_share(const Grid<Pixel>& frame, KnowsAlbedo knows_albedo, int x, int y, double noise_ratio) {
  double near = 0, far = 0;
  for (int v = y - 3; v <= y + 3; ++v) {
    for (int u = x - 3; u <= x + 3; ++u) {
      if ((u == x && v == y) || !frame.at(u, v).finite) continue;
      double light = 0;
      for (int j = -2; j <= 2; ++j) {
        for (int i = -2; i <= 2; ++i) {
          const Pixel& tap = frame.at(u + i, v + j);
          for (std::size_t c = 0; c < 3; ++c) {
            constexpr std::array<double, 3> luminance{0.2126, 0.7152, 0.0722};
            light +=
                luminance[c] * tap.color[c] / (knows_albedo == KnowsAlbedo::yes ? divisor(tap, c) : 1.0) / 25;
          }
        }
      }
      const double scale = std::pow(light + 0.1 / kExposure, -2);
      for (const auto& [i, j] : {std::pair(-1, -1), std::pair(1, -1), std::pair(-1, 1), std::pair(1, 1)})
        near += scale * squared_difference(frame, knows_albedo, u + i, v + j, 1) / 4;
      far += scale * squared_difference(frame, knows_albedo, u, v, 2);
    }
  }
  return std::clamp((6 - far / near / noise_ratio) / 3, 0.1, 1.0);
}

double mean_of(const Grid<double>& image) {
  return std::accumulate(image.data.begin(), image.data.end(), 0.0) / static_cast<double>(image.data.size());
}

/// How much of noise with this ratio the estimates lack.
double shared_factor(double noise_ratio, KnowsAlbedo knows_albedo) {
  return knows_albedo == KnowsAlbedo::yes ? std::sqrt(noise_ratio) : noise_ratio;
}

class EstimateVarianceTest : public DeviceTest {
 protected:
  static Grid<double> estimate(const Grid<Pixel>& frame, KnowsAlbedo knows_albedo = KnowsAlbedo::yes,
                               float noise_ratio = 1.0f) {
    const gpu::Extent full{frame.width, frame.height};
    gpu::Chain chain(device(), "variance estimate test");
    const gpu::ImageId color = chain.input("color", gpu::Format::f32x4, full);
    const gpu::ImageId valid = chain.input("valid", gpu::Format::f32x2, full);
    const SurfaceImages features{.albedo_depth = chain.input("albedo_depth", gpu::Format::f32x4, full),
                                 .normal = chain.input("normal", gpu::Format::f32x4, full)};
    FrameWithoutVariance inputs{.color = color,
                                .valid = valid,
                                .exposure = chain.table("exposure", gpu::Format::f32, {1, 1}),
                                .noise_ratio = chain.table("noise_ratio", gpu::Format::f32, {1, 1}),
                                .features = {}};
    if (knows_albedo == KnowsAlbedo::yes) inputs.features = features;
    const gpu::ImageId variance = add_variance_estimate(chain, full, inputs);
    chain.output(variance);
    chain.build();
    chain.upload<float>(inputs.exposure)[0] = kExposure;
    chain.upload<float>(inputs.noise_ratio)[0] = noise_ratio;
    for (std::size_t i = 0; i < frame.data.size(); ++i) {
      const Pixel& pixel = frame.data[i];
      std::ranges::copy(pixel.color, chain.upload<float>(color).begin() + 4 * i);
      chain.upload<float>(valid)[2 * i + 1] = pixel.finite ? 1.0f : 0.0f;
      std::ranges::copy(pixel.albedo_depth, chain.upload<float>(features.albedo_depth).begin() + 4 * i);
      std::ranges::copy(pixel.normal, chain.upload<float>(features.normal).begin() + 4 * i);
    }
    chain.run();
    Grid<double> result(frame.width, frame.height);
    for (std::size_t i = 0; i < result.data.size(); ++i) {
      result.data[i] = chain.download<float>(variance)[2 * i];
      EXPECT_EQ(chain.download<float>(variance)[2 * i + 1], frame.data[i].finite ? 1.0f : 0.0f);
    }
    return result;
  }

  /// As if nothing were detail and all noise independent.
  static Grid<double> whole_estimate(const Grid<Pixel>& frame, KnowsAlbedo knows_albedo) {
    constexpr float kNothingIsDetail = 1e6f;
    Grid<double> result = estimate(frame, knows_albedo, kNothingIsDetail);
    for (double& value : result.data) value /= shared_factor(kNothingIsDetail, knows_albedo);
    return result;
  }
};

/// Two walls with coarse-grained albedo under light that falls off. `noise` is its relative standard
/// deviation.
Grid<Pixel> textured(int width, int height, double noise) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Grid<Pixel> frame(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Pixel& pixel = frame.at(x, y);
      const bool wall = x + y / 2 < width / 2;
      const double light = (wall ? 0.3 : 1.5) + 0.02 * x;
      pixel.normal = wall ? std::array{1.0, 0.0, 0.0} : std::array{0.0, 0.6, 0.8};
      for (std::size_t c = 0; c < 3; ++c) {
        pixel.albedo_depth[c] = (x / 2 + y / 3 + static_cast<int>(c)) % 2 ? 0.8 : 0.1;
        pixel.color[c] = light * pixel.albedo_depth[c] * (1 + noise * normal(random));
      }
      pixel.albedo_depth[3] = 0.5 + 0.01 * y + (wall ? 0.0 : 0.4);
    }
  }
  return frame;
}

TEST_F(EstimateVarianceTest, IsTheFormulaInDouble) {
  Grid<Pixel> frame = textured(23, 17, 0.3);
  for (std::size_t i = 3; i < frame.data.size(); i += 29) frame.data[i].finite = false;
  frame.at(9, 9).normal = {0, -1, 0};  // unlike all its neighbours
  const Grid<double> got = whole_estimate(frame, KnowsAlbedo::yes);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      if (!frame.at(x, y).finite) continue;
      const double expected = reference_estimate(frame, x, y);
      EXPECT_NEAR(got.at(x, y), expected, 1e-3 * expected + 1e-6) << x << ' ' << y;
    }
  }
}

TEST_F(EstimateVarianceTest, TextureAndEdgesAreNoNoise) {
  // Little noise and much texture: a difference of neighbours would measure the texture.
  constexpr double noise = 0.03;
  const Grid<Pixel> frame = textured(64, 48, noise);
  const Grid<double> got = estimate(frame);
  double relative = 0;
  for (std::size_t i = 0; i < got.data.size(); ++i) {
    double truth = 0;
    for (const double value : frame.data[i].color) truth += std::pow(value * noise, 2) / 3;
    relative += got.data[i] / truth / static_cast<double>(got.data.size());
  }
  EXPECT_GT(relative, 0.8);
  EXPECT_LT(relative, 1.6);
}

TEST_F(EstimateVarianceTest, WithoutAlbedoIsTheFormulaInDouble) {
  const Grid<Pixel> frame = textured(23, 17, 0.3);
  const Grid<double> got = whole_estimate(frame, KnowsAlbedo::no);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const double expected = reference_second_difference(frame, x, y);
      EXPECT_NEAR(got.at(x, y), expected, 1e-4 * expected + 1e-6) << x << ' ' << y;
    }
  }
}

TEST_F(EstimateVarianceTest, TheShareOfNoiseIsTheFormulaInDouble) {
  Grid<Pixel> frame = textured(31, 29, 0.1);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      for (double& value : frame.at(x, y).color)
        value *= x > 15 ? 1.5 + std::sin(x) * std::sin(0.8 * y) : 1.0;
    }
  }
  frame.at(20, 11).finite = false;
  double least = 1.0;
  double most = 0.0;
  for (const KnowsAlbedo knows_albedo : {KnowsAlbedo::no, KnowsAlbedo::yes}) {
    for (const double noise_ratio : {1.0, 2.0}) {
      const Grid<double> whole = whole_estimate(frame, knows_albedo);
      const Grid<double> got = estimate(frame, knows_albedo, static_cast<float>(noise_ratio));
      for (int y = 5; y < frame.height - 5; ++y) {
        for (int x = 5; x < frame.width - 5; ++x) {
          const double share = reference_share(frame, knows_albedo, x, y, noise_ratio);
          const double expected = share * shared_factor(noise_ratio, knows_albedo) * whole.at(x, y);
          EXPECT_NEAR(got.at(x, y), expected, 2e-4 * whole.at(x, y)) << x << ' ' << y;
          least = std::min(least, share);
          most = std::max(most, share);
        }
      }
    }
  }
  EXPECT_LT(least, 0.5);
  EXPECT_GT(most, 0.9);
}

TEST_F(EstimateVarianceTest, DetailThatSpansPixelsIsNoNoise) {
  constexpr double noise = 0.01;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Grid<Pixel> frame(64, 48);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const double waves = 1.0 + 0.3 * std::sin(0.9 * x) * std::sin(0.9 * y);
      frame.at(x, y).color.fill(waves + noise * normal(random));
    }
  }
  EXPECT_GT(mean_of(whole_estimate(frame, KnowsAlbedo::no)), 2.5 * noise * noise);
  EXPECT_LT(mean_of(estimate(frame, KnowsAlbedo::no)), 0.8 * noise * noise);
}

TEST_F(EstimateVarianceTest, WithoutAlbedoGradientsAndStraightEdgesAreNoNoise) {
  Grid<Pixel> frame(24, 16);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      frame.at(x, y).color.fill((x % 5 == 0 ? 4.0 : 0.5) + 0.1 * x * x + (y > 7 ? 3.0 : 0.0));
    }
  }
  for (const double got : estimate(frame, KnowsAlbedo::no).data) EXPECT_LT(got, 1e-8);
}

TEST_F(EstimateVarianceTest, NoiseOnAFlatSurfaceIsFoundWithoutBias) {
  std::mt19937 random(8);
  std::exponential_distribution<double> skewed(1.0);
  Grid<Pixel> frame(96, 64);
  for (Pixel& pixel : frame.data) pixel.color.fill(skewed(random));
  for (const KnowsAlbedo knows_albedo : {KnowsAlbedo::no, KnowsAlbedo::yes}) {
    // The standard deviation of the squares is below 3 for a variance of 1, and neighbouring estimates share
    // samples.
    EXPECT_NEAR(mean_of(estimate(frame, knows_albedo)), 1.0, 0.15);
  }
}

TEST_F(EstimateVarianceTest, NoiseThatNeighboursShareIsFoundAsWell) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  Grid<double> samples(98, 66);
  for (double& sample : samples.data) sample = normal(random);
  // Ratios from the autocorrelation of [w, 1 - 2w, w] along both axes.
  for (const auto& [w, noise_ratio] :
       {std::pair(0.08, 1.71f), std::pair(0.14, 3.22f), std::pair(0.2, 8.38f)}) {
    Grid<Pixel> frame(96, 64);
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        double sum = 0;
        for (int j = 0; j < 3; ++j) {
          for (int i = 0; i < 3; ++i)
            sum += (i == 1 ? 1 - 2 * w : w) * (j == 1 ? 1 - 2 * w : w) * samples.at(x + i, y + j);
        }
        frame.at(x, y).color.fill(10 + sum);
      }
    }
    const double truth = std::pow(2 * w * w + (1 - 2 * w) * (1 - 2 * w), 2);
    for (const KnowsAlbedo knows_albedo : {KnowsAlbedo::no, KnowsAlbedo::yes}) {
      const double found = mean_of(estimate(frame, knows_albedo, noise_ratio)) / truth;
      EXPECT_GT(found, 0.7) << w;
      EXPECT_LT(found, 1.4) << w;
    }
  }
}

TEST_F(EstimateVarianceTest, WithoutAlbedoALonePixelIsAllNoise) {
  Grid<Pixel> frame(1, 1);
  frame.data[0].color = {1, 2, 3};
  EXPECT_NEAR(estimate(frame, KnowsAlbedo::no).data[0], 14.0 / 3, 1e-5);
}

TEST_F(EstimateVarianceTest, WithoutAlbedoTwoPixelsDifferByTwiceTheNoise) {
  for (const auto& [width, height] : {std::pair(2, 1), std::pair(1, 2)}) {
    Grid<Pixel> frame(width, height);
    frame.data[0].color = {1, 2, 3};
    for (const double variance : estimate(frame, KnowsAlbedo::no).data)
      EXPECT_NEAR(variance, 14.0 / 3 / 2, 1e-5) << width;
  }
}

TEST_F(EstimateVarianceTest, IsFiniteForTheSmallestAndTheBrightest) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 4), std::pair(2, 1), std::pair(1, 9)}) {
    for (const double value : {0.0, 1e-30, 1e30, -1e30, 3e38}) {
      Grid<Pixel> frame(width, height);
      for (Pixel& pixel : frame.data) pixel.color.fill(value);
      frame.data.back().color.fill(0.5 * value);
      for (const KnowsAlbedo knows_albedo : {KnowsAlbedo::no, KnowsAlbedo::yes}) {
        for (const double got : estimate(frame, knows_albedo).data) {
          EXPECT_GE(got, 0.0);
          EXPECT_LE(got, 1.01e34);
        }
      }
    }
  }
}

}  // namespace
}  // namespace becalm::filter
