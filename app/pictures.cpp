#include "app/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

#include "frame/compared_pixels.h"
#include "frame/error.h"
#include "frame/pictures/pictures.h"
#include "frame/srgb.h"

namespace becalm::app {
namespace {

using Color = std::array<double, 3>;

/// Black, violet, red, amber, white: luminance rises with the error, so that it reads in grey too.
constexpr std::array<Color, 5> kHeat{
    {{0.0, 0.0, 0.02}, {0.33, 0.07, 0.43}, {0.80, 0.22, 0.26}, {0.98, 0.62, 0.10}, {1.0, 1.0, 0.90}}};
/// Blue, nearly black, red, with a light tint at the ends.
constexpr std::array<Color, 5> kScores{
    {{0.62, 0.80, 1.0}, {0.16, 0.36, 0.86}, {0.05, 0.05, 0.06}, {0.86, 0.24, 0.16}, {1.0, 0.82, 0.62}}};
constexpr Color kNotFinite{0.0, 0.8, 1.0};
constexpr Color kNoScore{0.2, 0.9, 0.2};

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255.0));
}

/// `share` in [0,1] of the way along the colours.
Color blended(std::span<const Color> colors, double share) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(colors.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(position), colors.size() - 2);
  const double blend = position - static_cast<double>(below);
  Color color;
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = colors[below][c] * (1.0 - blend) + colors[below + 1][c] * blend;
  return color;
}

std::string css(std::span<const Color> colors) {
  std::string text;
  for (const Color& color : colors) {
    text += fmt::format("{}rgb({}, {}, {})", text.empty() ? "" : ", ", to_byte(color[0]), to_byte(color[1]),
                        to_byte(color[2]));
  }
  return text;
}

/// A picture of `image`'s size; `color_at(x, y)` returns the displayed colour.
template <class ColorAt>
Picture picture_of(const Image& image, ColorAt color_at) {
  Picture picture{image.width(), image.height(), {}};
  picture.rgb.reserve(image.pixel_count() * 3);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (const double value : color_at(x, y)) picture.rgb.push_back(to_byte(value));
    }
  }
  return picture;
}

/// The same expression as rel_mse, one pixel at a time.
double pixel_error(std::span<const float> test, std::span<const float> reference, int channels) {
  double sum = 0.0;
  for (int c = 0; c < channels; ++c) {
    const double difference = double(test[c]) - reference[c];
    sum += difference * difference / (double(reference[c]) * reference[c] + 0.01);
  }
  return sum / channels;
}

/// The score of largest magnitude, or one that is NaN.
double pixel_score(std::span<const float> scores) {
  double largest = 0.0;
  for (const float score : scores) {
    if (std::isnan(score)) return score;
    if (std::abs(score) > std::abs(largest)) largest = score;
  }
  return largest;
}

}  // namespace

Picture display_picture(const Image& image, double exposure) {
  return picture_of(image, [&](int x, int y) {
    Color color;
    for (int c = 0; c < 3; ++c) {
      const double value = image.at(x, y, std::min(c, compared_channels(image) - 1));
      color[c] = std::isfinite(value) ? srgb_encoded(value * exposure) : kNotFinite[c];
    }
    return color;
  });
}

double automatic_exposure(const Image& image) {
  std::vector<float> brightest;
  brightest.reserve(image.pixel_count());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const std::span<const float> pixel = image.pixel(x, y).first(compared_channels(image));
      const float value = std::ranges::max(pixel);
      if (std::isfinite(value)) brightest.push_back(value);
    }
  }
  if (brightest.empty()) return 1.0;
  const auto at = brightest.begin() + static_cast<std::ptrdiff_t>(brightest.size() * 19 / 20);
  std::ranges::nth_element(brightest, at);
  constexpr double nearly_white = 0.9;
  return *at > 0.0f ? nearly_white / *at : 1.0;
}

Picture error_picture(const Image& test, const Image& reference) {
  return picture_of(test, [&](int x, int y) {
    const double error = pixel_error(test.pixel(x, y), reference.pixel(x, y), compared_channels(test));
    if (!std::isfinite(error)) return kNotFinite;
    return blended(kHeat, std::log(std::max(error, kCoolestError) / kCoolestError) /
                              std::log(kHottestError / kCoolestError));
  });
}

std::string error_scale_css() {
  return css(kHeat);
}

Picture score_picture(const Image& scores) {
  return picture_of(scores, [&](int x, int y) {
    const double score = pixel_score(scores.pixel(x, y));
    return std::isnan(score) ? kNoScore : blended(kScores, 0.5 + 0.5 * score / kLargestScore);
  });
}

std::string score_scale_css() {
  return css(kScores);
}

std::vector<unsigned char> png_bytes(const Picture& picture) {
  pictures::Library& library = pictures::library();
  try {
    return library.png_bytes(picture.width, picture.height, picture.rgb);
  } catch (const std::runtime_error& error) {
    throw Error(ExitStatus::resource, fmt::format("cannot make a PNG picture: {}", error.what()));
  }
}

}  // namespace becalm::app
