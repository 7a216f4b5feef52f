#include "frame/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace becalm {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Image single(float value) {
  return {1, 1, 1, value};
}

Image random_image(int width, int height, int channels, unsigned seed, float low = 0.0f, float high = 1.0f) {
  Image image(width, height, channels);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high);
  for (float& v : image.data()) v = value(random);
  return image;
}

/// Mean of `term(x, y, c)` over the first three channels, in the plainest way.
double naive_mean(const Image& shape, auto term) {
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < shape.height(); ++y) {
    for (int x = 0; x < shape.width(); ++x) {
      for (int c = 0; c < std::min(3, shape.channels()); ++c, ++count) sum += term(x, y, c);
    }
  }
  return sum / count;
}

/// SSIM pixel by pixel from the definition, with a weight of zero for pixels that are not finite.
double naive_ssim(const Image& a, const Image& b) {
  const auto finite = [](const Image& image, int x, int y) {
    for (float v : image.pixel(x, y).first(std::min(3, image.channels()))) {
      if (!std::isfinite(v)) return false;
    }
    return true;
  };
  const auto luma = [](const Image& image, int x, int y) {
    const auto encode = [](double v) {
      v = std::min(std::max(v, 0.0), 1.0);
      return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    };
    if (image.channels() < 3) return encode(image.at(x, y, 0));
    return 0.2126 * encode(image.at(x, y, 0)) + 0.7152 * encode(image.at(x, y, 1)) +
           0.0722 * encode(image.at(x, y, 2));
  };
  const int margin = std::min(a.width(), a.height()) >= 11 ? 5 : 0;
  double total = 0.0;
  int count = 0;
  for (int y = margin; y < a.height() - margin; ++y) {
    for (int x = margin; x < a.width() - margin; ++x) {
      if (!finite(a, x, y) || !finite(b, x, y)) continue;
      const auto windowed = [&](auto value) {
        double sum = 0.0;
        double weights = 0.0;
        for (int j = std::max(0, y - 5); j <= std::min(a.height() - 1, y + 5); ++j) {
          for (int i = std::max(0, x - 5); i <= std::min(a.width() - 1, x + 5); ++i) {
            if (!finite(a, i, j) || !finite(b, i, j)) continue;
            const double w = std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / (2 * 1.5 * 1.5));
            sum += w * value(i, j);
            weights += w;
          }
        }
        return sum / weights;
      };
      const double ma = windowed([&](int i, int j) { return luma(a, i, j); });
      const double mb = windowed([&](int i, int j) { return luma(b, i, j); });
      const double va = windowed([&](int i, int j) { return std::pow(luma(a, i, j) - ma, 2); });
      const double vb = windowed([&](int i, int j) { return std::pow(luma(b, i, j) - mb, 2); });
      const double ab = windowed([&](int i, int j) { return (luma(a, i, j) - ma) * (luma(b, i, j) - mb); });
      total += (2 * ma * mb + 1e-4) * (2 * ab + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
      ++count;
    }
  }
  return total / count;
}

TEST(RelMse, HandComputed) {
  EXPECT_NEAR(rel_mse(single(3.0f), single(1.0f)).value, 4.0 / 1.01, 1e-12);
  EXPECT_NEAR(rel_mse(single(0.5f), single(0.0f)).value, 25.0, 1e-12);
  EXPECT_EQ(rel_mse(single(0.25f), single(0.25f)).value, 0.0);
}

TEST(RelMse, AgreesWithTheDefinition) {
  const Image x = random_image(13, 7, 4, 1);
  const Image r = random_image(13, 7, 4, 2);
  const double expected = naive_mean(x, [&](int i, int j, int c) {
    const double d = double{x.at(i, j, c)} - r.at(i, j, c);
    return d * d / (double{r.at(i, j, c)} * r.at(i, j, c) + 0.01);
  });
  EXPECT_NEAR(rel_mse(x, r).value, expected, 1e-12);
}

TEST(RelMse, AlphaDoesNotCount) {
  Image x = random_image(5, 5, 4, 1);
  const Image r = x;
  for (int i = 0; i < 25; ++i) x.data()[i * 4 + 3] = kNan;
  EXPECT_EQ(rel_mse(x, r).value, 0.0);
  EXPECT_EQ(rel_mse(x, r).skipped, 0u);
}

TEST(RelMse, TwoReferencesHandComputed) {
  // (3-1)(3-2) / (1.5^2 + 0.01)
  EXPECT_NEAR(rel_mse(single(3.0f), single(1.0f), single(2.0f)).value, 2.0 / 2.26, 1e-12);
  // An image between its references has a negative error.
  EXPECT_NEAR(rel_mse(single(1.5f), single(1.0f), single(2.0f)).value, -0.25 / 2.26, 1e-12);
}

TEST(RelMse, TwoNoisyReferencesAreUnbiased) {
  // Truth 1, test off by 0.1 either way: the product form finds 0.01 / 1.01 where one reference adds its
  // variance.
  const int side = 200;
  Image test(side, side, 3, 1.1f);
  for (std::size_t i = 0; i < test.data().size(); i += 2) test.data()[i] = 0.9f;
  const Image a = random_image(side, side, 3, 1, 0.9f, 1.1f);
  const Image b = random_image(side, side, 3, 2, 0.9f, 1.1f);
  const double truth = 0.01 / 1.01;
  EXPECT_NEAR(rel_mse(test, a, b).value, truth, 0.02 * truth);
  EXPECT_GT(rel_mse(test, a).value, 1.3 * truth);
}

TEST(TemporalError, HandComputed) {
  // ((4-1) - (3-2))^2 / ((9+4)/2 + 0.01)
  EXPECT_NEAR(temporal_error(single(4.0f), single(1.0f), single(3.0f), single(2.0f)).value, 4.0 / 6.51,
              1e-12);
  // A constant offset is no temporal error.
  EXPECT_NEAR(temporal_error(single(4.0f), single(3.0f), single(2.0f), single(1.0f)).value, 0.0, 1e-12);
}

TEST(TemporalError, TwoReferencesHandComputed) {
  // a: 3 -> 2 before, b: 5 -> 1 before; r = 4, r_before = 1.5
  EXPECT_NEAR(
      temporal_error(single(7.0f), single(1.0f), single(3.0f), single(2.0f), single(5.0f), single(1.0f))
          .value,
      (6.0 - 1.0) * (6.0 - 4.0) / ((16.0 + 2.25) / 2 + 0.01), 1e-12);
}

TEST(TemporalError, TwoEqualReferencesAreOne) {
  const Image x = random_image(9, 9, 3, 1);
  const Image y = random_image(9, 9, 3, 2);
  const Image r = random_image(9, 9, 3, 3);
  const Image s = random_image(9, 9, 3, 4);
  EXPECT_NEAR(temporal_error(x, y, r, s, r, s).value, temporal_error(x, y, r, s).value, 1e-12);
}

TEST(Energy, HandComputed) {
  EXPECT_NEAR(energy(single(3.0f), single(2.0f)).value, 0.5, 1e-12);
  EXPECT_NEAR(energy(single(3.0f), single(2.0f), single(6.0f)).value, -0.25, 1e-12);
  EXPECT_EQ(energy(single(0.0f), single(0.0f)).value, 0.0);
  EXPECT_EQ(energy(single(1.0f), single(0.0f)).value, kInf);
}

TEST(Energy, IsTheRatioOfMeansNotTheMeanOfRatios) {
  Image x(2, 1, 1);
  Image r(2, 1, 1);
  x.data()[0] = 1.0f, x.data()[1] = 9.0f;
  r.data()[0] = 2.0f, r.data()[1] = 3.0f;
  EXPECT_NEAR(energy(x, r).value, 1.0, 1e-12);
}

TEST(Psnr, HandComputed) {
  EXPECT_NEAR(psnr(single(0.6f), single(0.5f)).value, 20.0, 1e-5);
  EXPECT_NEAR(psnr(single(60.0f), single(50.0f), 100.0).value, 20.0, 1e-12);
  EXPECT_EQ(psnr(single(0.5f), single(0.5f)).value, kInf);
  EXPECT_NEAR(psnr(single(3.0f), single(1.0f), single(2.0f), 10.0).value, 10 * std::log10(100.0 / 2.0),
              1e-12);
  EXPECT_EQ(psnr(single(1.5f), single(1.0f), single(2.0f), 1.0).value, kInf);
}

TEST(Ssim, EqualImagesAreOne) {
  const Image x = random_image(20, 14, 3, 1);
  EXPECT_NEAR(ssim(x, x).value, 1.0, 1e-12);
}

TEST(Ssim, BlackAgainstWhite) {
  // Means 0 and 1, no variance: C1 / (1 + C1).
  EXPECT_NEAR(ssim(Image(12, 12, 3, 0.0f), Image(12, 12, 3, 5.0f)).value, 1e-4 / 1.0001, 1e-12);
}

TEST(Ssim, AgreesWithTheDefinition) {
  for (const auto& [width, height, channels] :
       {std::array{31, 23, 3}, std::array{11, 40, 4}, std::array{40, 11, 1}, std::array{6, 9, 3},
        std::array{1, 1, 3}, std::array{1, 30, 3}}) {
    const Image x = random_image(width, height, channels, 1, -0.2f, 1.2f);
    const Image y = random_image(width, height, channels, 2, -0.2f, 1.2f);
    EXPECT_NEAR(ssim(x, y).value, naive_ssim(x, y), 1e-9) << width << 'x' << height;
  }
}

TEST(Ssim, TheNoiseOfTwoReferencesIsNoError) {
  const Image truth = random_image(96, 80, 3, 1, 0.3f, 0.6f);
  const auto noisy = [&](unsigned seed) {
    Image image = random_image(96, 80, 3, seed, -0.15f, 0.15f);
    for (std::size_t i = 0; i < image.data().size(); ++i) image.data()[i] += truth.data()[i];
    return image;
  };
  const Image a = noisy(2);
  const Image b = noisy(3);
  EXPECT_LT(ssim(truth, a).value, 0.9);
  EXPECT_NEAR(ssim(truth, a, b).value, 1.0, 0.02);
  EXPECT_LT(ssim(noisy(4), a, b).value, 0.9);
  EXPECT_EQ(ssim(noisy(4), a, a).value, ssim(noisy(4), a).value);
}

TEST(Ssim, PixelsThatAreNotFiniteHaveNoWeight) {
  Image x = random_image(24, 24, 3, 1);
  Image y = random_image(24, 24, 3, 2);
  x.at(10, 12, 1) = kNan;
  y.at(0, 0, 2) = kInf;
  y.at(12, 13, 0) = -kInf;
  EXPECT_NEAR(ssim(x, y).value, naive_ssim(x, y), 1e-9);
  EXPECT_EQ(ssim(x, y).skipped, 3u);
}

TEST(Metrics, PixelsThatAreNotFiniteAreSkippedInAllImages) {
  Image x(4, 1, 3, 1.5f);
  Image r(4, 1, 3, 1.0f);
  x.at(0, 0, 2) = kNan;
  r.at(1, 0, 0) = kInf;
  r.at(1, 0, 1) = kNan;  // one pixel however many channels
  for (const Measured& measured : {rel_mse(x, r), rel_mse(x, r, r), temporal_error(x, r, r, x), energy(x, r),
                                   energy(x, r, r), psnr(x, r), psnr(x, r, r, 1.0)}) {
    EXPECT_EQ(measured.skipped, 2u);
    EXPECT_TRUE(std::isfinite(measured.value));
  }
  EXPECT_NEAR(rel_mse(x, r).value, 0.25 / 1.01, 1e-12);
  EXPECT_NEAR(energy(x, r).value, 0.5, 1e-12);
}

TEST(Metrics, NothingMeasurableIsNotANumber) {
  const Image x(2, 2, 3, kNan);
  const Image r(2, 2, 3, 1.0f);
  for (const Measured& measured :
       {rel_mse(x, r), rel_mse(r, r, x), temporal_error(x, r, r, r), energy(x, r), psnr(x, r), ssim(x, r)}) {
    EXPECT_TRUE(std::isnan(measured.value));
    EXPECT_EQ(measured.skipped, 4u);
  }
}

TEST(Metrics, SumsSurviveExtremes) {
  EXPECT_NEAR(rel_mse(single(2e30f), single(1e30f)).value, 1.0, 1e-6);
  EXPECT_NEAR(energy(single(2e-30f), single(1e-30f)).value, 1.0, 1e-6);
  EXPECT_NEAR(rel_mse(single(1e-30f), single(0.0f)).value, 1e-58, 1e-63);
  EXPECT_NEAR(rel_mse(single(-1.0f), single(1.0f)).value, 4.0 / 1.01, 1e-12);
  // A million values of 0.1f would drift in a float sum.
  const Image x(1000, 400, 3, 0.1f);
  const Image r(1000, 400, 3, 0.2f);
  EXPECT_NEAR(energy(x, r).value, -0.5, 1e-12);
}

TEST(Metrics, ImagesOfDifferentShapesAreRefused) {
  const Image x(3, 2, 3);
  EXPECT_THROW(rel_mse(x, Image(2, 3, 3)), std::invalid_argument);
  EXPECT_THROW(rel_mse(x, x, Image(3, 3, 3)), std::invalid_argument);
  EXPECT_THROW(ssim(x, Image(3, 2, 1)), std::invalid_argument);
  EXPECT_THROW(energy(Image(), Image()), std::invalid_argument);
  EXPECT_THROW(temporal_error(x, x, x, Image(4, 2, 3)), std::invalid_argument);
  EXPECT_NO_THROW(rel_mse(x, Image(3, 2, 4)));  // three channels against those of RGBA
}

}  // namespace
}  // namespace becalm
