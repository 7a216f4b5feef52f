#pragma once

#include <initializer_list>
#include <random>

#include "filter/settings.h"
#include "frame/frame.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::moving_pattern {

inline constexpr int kWidth = 96;
inline constexpr int kHeight = 64;

inline AovSet aov_set(std::initializer_list<Aov> aovs) {
  AovSet set;
  for (const Aov aov : aovs) set.set(static_cast<std::size_t>(aov));
  return set;
}

/// The clean value of a pattern that moves by (2, -1) px per frame.
inline double clean(int x, int y, int number) {
  return 0.1 + pattern(x + 2.0 * number, y - 1.0 * number, 9);
}

/// A frame of that animation with skewed noise of 4 samples (exponentially distributed, as from rare bright
/// paths).
inline Frame noisy_frame(int number) {
  std::mt19937 random(number + 1);
  std::exponential_distribution<double> exponential;
  Frame frame(number, kWidth, kHeight);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& variance = frame.add(Aov::variance);
  Image& albedo = frame.add(Aov::albedo);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double value = clean(x, y, number);
      for (int c = 0; c < 3; ++c) {
        double sum = 0, squares = 0;
        for (int s = 0; s < 4; ++s) {
          const double radiance = value * exponential(random);
          sum += radiance;
          squares += radiance * radiance;
        }
        beauty.at(x, y, c) = static_cast<float>(sum / 4);
        variance.at(x, y, c) = static_cast<float>((squares - sum * sum / 4) / (3 * 4));
        albedo.at(x, y, c) = static_cast<float>(value / 1.2);
      }
    }
  }
  return frame;
}

inline double squared_error(const Frame& frame) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double d = frame.image(Aov::beauty).at(x, y, 1) - clean(x, y, frame.number());
      sum += d * d;
    }
  }
  return sum / (kWidth * kHeight);
}

inline double mean(const Frame& frame) {
  double sum = 0;
  for (std::size_t i = 0; i < frame.image(Aov::beauty).pixel_count(); ++i)
    sum += frame.image(Aov::beauty).data()[4 * i + 1];
  return sum / (kWidth * kHeight);
}

/// The balanced preset without smoothing.
inline Settings unsmoothed() {
  Settings settings = preset("balanced");
  settings.smooth = Smooth::none;
  return settings;
}

}  // namespace becalm::filter::moving_pattern
