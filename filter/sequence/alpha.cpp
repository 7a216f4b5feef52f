#include "filter/sequence/alpha.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "filter/for_rows.h"

namespace becalm::filter {
namespace {

/// Smaller steps are ignored: they are invisible and may come from rounding or dithering to 8 bits.
constexpr float kStep = 1.0f / 64.0f;
/// Radius of the window in which rough pixels are counted.
constexpr int kNoiseReach = 7;
/// Under noise of 4 samples or more, about a tenth of the pixels that differ from a neighbour are rough (5 %
/// to 16 %, by coverage and samples). Windows vary, so half of that is enough: at least one in kShareOfRough.
/// Edges have rough pixels only where they cross.
constexpr int kFewestRough = 6;
constexpr int kShareOfRough = 20;
/// Transparent pixels within this distance of an empty pixel must be black, and no alpha noisy. It is farther
/// than a colour's own noise extends.
constexpr int kEmptyReach = 2;

/// Sums of a mask over windows.
class WindowSums {
 public:
  WindowSums(std::span<const std::uint8_t> mask, int width, int height)
      : width_(width), height_(height), sums_((width + 1) * (std::size_t{1} + height)) {
    for (int y = 0; y < height; ++y) {
      int row = 0;
      for (int x = 0; x < width; ++x) {
        row += mask[static_cast<std::size_t>(y) * width + x];
        at(x + 1, y + 1) = at(x + 1, y) + row;
      }
    }
  }

  /// The sum over the pixels at most `reach` away in x and y.
  int around(int x, int y, int reach) const {
    const int x0 = std::max(x - reach, 0);
    const int y0 = std::max(y - reach, 0);
    const int x1 = std::min(x + reach + 1, width_);
    const int y1 = std::min(y + reach + 1, height_);
    return at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0);
  }

 private:
  int& at(int x, int y) { return sums_[static_cast<std::size_t>(y) * (width_ + 1) + x]; }
  int at(int x, int y) const { return sums_[static_cast<std::size_t>(y) * (width_ + 1) + x]; }

  int width_;
  int height_;
  std::vector<int> sums_;
};

constexpr std::array<std::pair<int, int>, 4> kFourDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};

/// Steps of alpha between a pixel and its neighbours.
struct Steps {
  bool any = false;      ///< there is a step
  bool reverses = true;  ///< in every direction alpha rises to both sides or falls to both sides
};

Steps steps_at(const Image& beauty, int x, int y) {
  Steps steps;
  const float own = beauty.at(x, y, 3);
  const auto step_to = [&](int u, int v) {
    const bool inside = u >= 0 && v >= 0 && u < beauty.width() && v < beauty.height();
    const float step = inside ? beauty.at(u, v, 3) - own : 0.0f;
    return std::abs(step) > kStep ? step : 0.0f;
  };
  for (const auto& [dx, dy] : kFourDirections) {
    const float forward = step_to(x + dx, y + dy);
    const float backward = step_to(x - dx, y - dy);
    steps.any = steps.any || forward != 0.0f || backward != 0.0f;
    steps.reverses = steps.reverses && forward * backward > 0.0f;
  }
  return steps;
}

}  // namespace

std::vector<std::uint8_t> noisy_alpha(const Image& beauty) {
  const int width = beauty.width();
  const int height = beauty.height();
  std::vector<std::uint8_t> differs(beauty.pixel_count());
  std::vector<std::uint8_t> rough(beauty.pixel_count());
  for_each_pixel(width, height, [&](int x, int y, std::size_t i) {
    const Steps steps = steps_at(beauty, x, y);
    differs[i] = steps.any ? 1 : 0;
    rough[i] = steps.reverses ? 1 : 0;
  });
  const WindowSums count_differing(differs, width, height);
  const WindowSums count_rough(rough, width, height);
  std::vector<std::uint8_t> noisy(beauty.pixel_count());
  for_each_pixel(width, height, [&](int x, int y, std::size_t i) {
    const int found = count_rough.around(x, y, kNoiseReach);
    const bool many =
        found >= kFewestRough && kShareOfRough * found >= count_differing.around(x, y, kNoiseReach);
    noisy[i] = differs[i] != 0 && many ? 1 : 0;
  });
  return noisy;
}

std::vector<std::uint8_t> empty_pixels(const Image& beauty, std::span<const std::uint8_t> noisy) {
  std::vector<std::uint8_t> black(beauty.pixel_count());
  std::vector<std::uint8_t> filled(beauty.pixel_count());  // though they may be transparent
  const std::size_t empty = sum_of_rows<std::size_t>(beauty.height(), [&](int y) {
    std::size_t of_row = 0;
    for (int x = 0; x < beauty.width(); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * beauty.width() + x;
      const std::span<const float> pixel = beauty.pixel(x, y);
      const bool transparent = pixel[3] == 0.0f;
      const bool is_black = pixel[0] == 0.0f && pixel[1] == 0.0f && pixel[2] == 0.0f;
      black[i] = transparent && is_black ? 1 : 0;
      filled[i] = (transparent && !is_black) || noisy[i] != 0 ? 1 : 0;
      of_row += transparent ? 1 : 0;
    }
    return of_row;
  });
  if (empty == 0) return black;
  const bool has_matte = empty < beauty.pixel_count();
  if (!has_matte) return std::vector<std::uint8_t>(beauty.pixel_count());
  const WindowSums count_filled(filled, beauty.width(), beauty.height());
  for_each_pixel(beauty.width(), beauty.height(), [&](int x, int y, std::size_t i) {
    if (count_filled.around(x, y, kEmptyReach) > 0) black[i] = 0;
  });
  return black;
}

void pass_on_alpha(const Image& beauty, std::span<const std::uint8_t> noisy, Image& denoised) {
  const auto width = static_cast<std::size_t>(beauty.width());
  for_rows(beauty.height(), [&](int begin, int end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      float& alpha = denoised.data()[4 * i + 3];
      alpha = noisy[i] != 0 ? std::clamp(alpha, 0.0f, 1.0f) : beauty.data()[4 * i + 3];
    }
  });
}

}  // namespace becalm::filter
