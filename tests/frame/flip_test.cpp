#include "frame/flip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

namespace becalm {
namespace {

using Color = std::array<double, 3>;

/// At so few pixels per degree every filter is a single pixel, the edge detector is (-1, 0, 1) and the point
/// detector (1/2, -1, 1/2), so that values can be had by hand.
constexpr double kCoarse = 1.0;

/// The largest distance of two colours to the power of 0.7, and what the published code has for black against
/// white: 100^0.7 = 25.119 is above 0.4 * 41.276, so 0.95 + 0.05 (25.119 - 16.510) / (41.276 - 16.510).
constexpr double kLargest = 41.2761;
const double kBlackToWhite = 0.95 + 0.05 * (std::pow(100.0, 0.7) - 0.4 * kLargest) / (0.6 * kLargest);

Image filled(int width, int height, const std::array<float, 3>& color) {
  Image image(width, height, 3);
  for (std::size_t i = 0; i < image.data().size(); ++i) image.data()[i] = color[i % 3];
  return image;
}

Image random_colors(int width, int height, int channels, unsigned seed) {
  Image image(width, height, channels);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-0.2f, 1.3f);
  for (float& v : image.data()) v = value(random);
  return image;
}

/// The metric pixel by pixel in the paper's order and colour spaces, with kernels of two dimensions.
class Definition {
 public:
  Definition(const Image& test, const Image& reference, double pixels_per_degree)
      : ppd_(pixels_per_degree), test_(test), reference_(reference) {}

  double mean() const {
    double sum = 0.0;
    for (int y = 0; y < test_.height(); ++y) {
      for (int x = 0; x < test_.width(); ++x) sum += at(x, y);
    }
    return sum / static_cast<double>(test_.pixel_count());
  }

 private:
  static double f(double t) {
    return t > std::pow(6.0 / 29.0, 3) ? std::cbrt(t) : 841.0 / 108.0 * t + 4.0 / 29.0;
  }

  /// The published matrix, as printed.
  static Color xyz_of(const Color& c) {
    return {0.4123866 * c[0] + 0.3575915 * c[1] + 0.1804505 * c[2],
            0.2126368 * c[0] + 0.7151830 * c[1] + 0.0721802 * c[2],
            0.0193306 * c[0] + 0.1191972 * c[1] + 0.9503726 * c[2]};
  }
  static Color rgb_of(const Color& c) {
    return {3.241003275 * c[0] - 1.537398934 * c[1] - 0.498615861 * c[2],
            -0.969224334 * c[0] + 1.875930071 * c[1] + 0.041554224 * c[2],
            0.055639423 * c[0] - 0.204011202 * c[1] + 1.057148933 * c[2]};
  }
  static constexpr Color kWhite{0.950428545, 1.0, 1.088900371};

  Color ycxcz(const Image& image, int x, int y) const {
    x = std::clamp(x, 0, image.width() - 1);
    y = std::clamp(y, 0, image.height() - 1);
    Color rgb;
    for (int c = 0; c < 3; ++c) {
      rgb[c] = std::clamp<double>(image.at(x, y, image.channels() < 3 ? 0 : c), 0.0, 1.0);
    }
    const Color xyz = xyz_of(rgb);
    return {116.0 * xyz[1] / kWhite[1] - 16.0, 500.0 * (xyz[0] / kWhite[0] - xyz[1] / kWhite[1]),
            200.0 * (xyz[1] / kWhite[1] - xyz[2] / kWhite[2])};
  }

  Color lab(const Image& image, int x, int y) const {
    constexpr double pi = std::numbers::pi;
    const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * ppd_));
    Color sum{};
    Color weights{};
    for (int j = -radius; j <= radius; ++j) {
      for (int i = -radius; i <= radius; ++i) {
        const auto term = [&](double a, double b) {
          return a * std::sqrt(pi / b) * std::exp(-pi * pi * (i * i + j * j) / (ppd_ * ppd_) / b);
        };
        const Color weight{term(1.0, 0.0047), term(1.0, 0.0053), term(34.1, 0.04) + term(13.5, 0.025)};
        const Color value = ycxcz(image, x + i, y + j);
        for (int c = 0; c < 3; ++c) sum[c] += weight[c] * value[c], weights[c] += weight[c];
      }
    }
    for (int c = 0; c < 3; ++c) sum[c] /= weights[c];
    const double yy = (sum[0] + 16.0) / 116.0;
    Color rgb =
        rgb_of({(yy + sum[1] / 500.0) * kWhite[0], yy * kWhite[1], (yy - sum[2] / 200.0) * kWhite[2]});
    for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
    return hunt_lab(rgb);
  }

  static Color hunt_lab(const Color& rgb) {
    const Color xyz = xyz_of(rgb);
    const double l = 116.0 * f(xyz[1] / kWhite[1]) - 16.0;
    return {l, 0.01 * l * 500.0 * (f(xyz[0] / kWhite[0]) - f(xyz[1] / kWhite[1])),
            0.01 * l * 200.0 * (f(xyz[1] / kWhite[1]) - f(xyz[2] / kWhite[2]))};
  }

  static double distance(const Color& a, const Color& b) {
    return std::pow(std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), 0.7);
  }

  /// The length of the detector's response in x and y.
  double feature(const Image& image, int x, int y, bool point) const {
    const double sd = 0.5 * 0.082 * ppd_;
    const int radius = static_cast<int>(std::ceil(3.0 * sd));
    std::array<double, 2> positive{};
    std::array<double, 2> negative{};
    std::array<double, 2> positive_weight{};
    std::array<double, 2> negative_weight{};
    for (int j = -radius; j <= radius; ++j) {
      for (int i = -radius; i <= radius; ++i) {
        const double value = (ycxcz(image, x + i, y + j)[0] + 16.0) / 116.0;
        const double g = std::exp(-(i * i + j * j) / (2.0 * sd * sd));
        for (int axis = 0; axis < 2; ++axis) {
          const double d = axis == 0 ? i : j;
          const double weight = point ? (d * d / (sd * sd) - 1.0) * g : -d * g;
          (weight > 0.0 ? positive : negative)[axis] += weight * value;
          (weight > 0.0 ? positive_weight : negative_weight)[axis] += std::abs(weight);
        }
      }
    }
    std::array<double, 2> response{};
    for (int axis = 0; axis < 2; ++axis) {
      response[axis] = positive[axis] / positive_weight[axis] + negative[axis] / negative_weight[axis];
    }
    return std::hypot(response[0], response[1]);
  }

  double at(int x, int y) const {
    const double largest = distance(hunt_lab({0.0, 1.0, 0.0}), hunt_lab({0.0, 0.0, 1.0}));
    const double d = distance(lab(test_, x, y), lab(reference_, x, y));
    const double color = d < 0.4 * largest ? 0.95 / (0.4 * largest) * d
                                           : 0.95 + (d - 0.4 * largest) / (largest - 0.4 * largest) * 0.05;
    const double edges = std::abs(feature(test_, x, y, false) - feature(reference_, x, y, false));
    const double points = std::abs(feature(test_, x, y, true) - feature(reference_, x, y, true));
    return std::pow(color, 1.0 - std::pow(std::max(edges, points) / std::sqrt(2.0), 0.5));
  }

  const double ppd_;
  const Image& test_;
  const Image& reference_;
};

TEST(Flip, EqualImagesHaveNone) {
  const Image image = random_colors(30, 20, 3, 1);
  EXPECT_EQ(flip(image, image).value, 0.0);
}

TEST(Flip, UniformImagesHandComputed) {
  const auto between = [](const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return flip(filled(25, 23, a), filled(25, 23, b)).value;
  };
  EXPECT_NEAR(between({0, 0, 0}, {1, 1, 1}), kBlackToWhite, 1e-6);
  EXPECT_NEAR(kBlackToWhite, 0.96738, 1e-5);
  // The most different colours of the paper.
  EXPECT_NEAR(between({0, 1, 0}, {0, 0, 1}), 1.0, 1e-6);
  // Grey of Y = 0.5 has L* = 76.0693; dark grey of Y = 0.001 is in the linear part: 903.3 * 0.001.
  EXPECT_NEAR(between({0, 0, 0}, {0.5f, 0.5f, 0.5f}),
              0.95 + 0.05 * (std::pow(76.0693, 0.7) - 0.4 * kLargest) / (0.6 * kLargest), 1e-5);
  EXPECT_NEAR(between({0, 0, 0}, {1e-3f, 1e-3f, 1e-3f}), 0.95 * std::pow(0.903296, 0.7) / (0.4 * kLargest),
              1e-5);
}

TEST(Flip, FeaturesHandComputed) {
  const Image black(9, 7, 3, 0.0f);
  // Of a white pixel both responses to points are -1: their length, sqrt(2), is the largest there is, and the
  // difference is 1. Its neighbours have edges, but no difference of colour.
  Image firefly = black;
  for (float& v : firefly.pixel(4, 3)) v = 1.0f;
  EXPECT_NEAR(flip(firefly, black, kCoarse).value, 1.0 / 63.0, 1e-9);
  // Left of a step there is no difference of colour; in the first white column the edge's response is 1.
  Image step = black;
  for (int y = 0; y < 7; ++y) {
    for (int x = 4; x < 9; ++x) {
      for (float& v : step.pixel(x, y)) v = 1.0f;
    }
  }
  const double at_edge = std::pow(kBlackToWhite, 1.0 - std::sqrt(1.0 / std::numbers::sqrt2));
  EXPECT_NEAR(flip(step, black, kCoarse).value, (at_edge + 4.0 * kBlackToWhite) / 9.0, 1e-6);
  EXPECT_NEAR(flip(black, step, kCoarse).value, (at_edge + 4.0 * kBlackToWhite) / 9.0, 1e-6);
}

TEST(Flip, AgreesWithTheDefinition) {
  for (const auto& [width, height, channels] :
       {std::array{31, 26, 3}, std::array{24, 7, 4}, std::array{5, 30, 1}, std::array{1, 1, 3}}) {
    const Image test = random_colors(width, height, channels, 1);
    const Image reference = random_colors(width, height, channels, 2);
    EXPECT_NEAR(flip(test, reference).value, Definition(test, reference, kFlipPixelsPerDegree).mean(), 1e-6)
        << width << 'x' << height;
    EXPECT_NEAR(flip(test, reference, 20.0).value, Definition(test, reference, 20.0).mean(), 1e-6)
        << width << 'x' << height;
  }
}

TEST(Flip, NoiseIsLessVisibleFromAfar) {
  const Image grey(40, 40, 3, 0.4f);
  const Image noisy = random_colors(40, 40, 3, 1);
  EXPECT_LT(flip(noisy, grey, 120.0).value, 0.8 * flip(noisy, grey, 20.0).value);
}

TEST(Flip, IsOfTheDisplayImage) {
  const Image one(12, 12, 3, 1.0f);
  EXPECT_EQ(flip(Image(12, 12, 3, 50.0f), one).value, 0.0);
  EXPECT_EQ(flip(Image(12, 12, 3, -1.0f), Image(12, 12, 3, 0.0f)).value, 0.0);
  Image with_alpha = random_colors(12, 12, 4, 1);
  const Image reference = with_alpha;
  for (int i = 0; i < 144; ++i) with_alpha.data()[i * 4 + 3] = 9.0f;
  EXPECT_EQ(flip(with_alpha, reference).value, 0.0);
}

TEST(Flip, PixelsThatAreNotFiniteAreSkipped) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Image test = random_colors(24, 24, 3, 1);
  Image reference = test;
  test.at(10, 12, 1) = nan;
  reference.at(3, 4, 2) = std::numeric_limits<float>::infinity();
  const Measured same = flip(test, reference);
  EXPECT_EQ(same.skipped, 2u);
  EXPECT_EQ(same.value, 0.0);
  const Measured nothing = flip(Image(4, 4, 3, nan), Image(4, 4, 3, 1.0f));
  EXPECT_TRUE(std::isnan(nothing.value));
  EXPECT_EQ(nothing.skipped, 16u);
}

TEST(Flip, ImagesOfDifferentShapesAreRefused) {
  const Image image(3, 2, 3);
  EXPECT_THROW(flip(image, Image(2, 3, 3)), std::invalid_argument);
  EXPECT_THROW(flip(image, Image(3, 2, 1)), std::invalid_argument);
  EXPECT_THROW(flip(Image(), Image()), std::invalid_argument);
}

}  // namespace
}  // namespace becalm
