#include "filter/stereo/disparity.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/for_rows.h"
#include "shaders/shared/limits.h"

namespace becalm::filter {

Correspondence correspondence_by_depth(const Frame& frame, float limit_px) {
  const Image& depth = frame.image(Aov::depth);
  const StereoView& view = *frame.stereo();
  StereoView other = view;
  other.eye = view.other_eye();
  const int width = frame.width();
  const int height = frame.height();
  Correspondence where{Image(width, height, 2, kNowhere), Image(width, height, 1)};
  for_rows(height, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        const double along_ray = depth.at(x, y, 0);
        if (!(along_ray > 0.0)) continue;  // NaN, or no depth
        const double z = along_ray * view.cosine(x + 0.5, y + 0.5, width, height);
        const double offset = view.offset_to_other_px(z);
        if (!(std::abs(offset) <= limit_px)) continue;
        where.offset.at(x, y, 0) = static_cast<float>(offset);
        where.offset.at(x, y, 1) = 0.0f;
        where.depth.at(x, y, 0) =
            static_cast<float>(z / other.cosine(x + 0.5 + offset, y + 0.5, width, height));
      }
    }
  });
  return where;
}

namespace {

/// Which pixels of one image lead to which of another, both of one size.
class Matches {
 public:
  Matches(const Image& offsets, const Image& residual)
      : offsets_(offsets), best_(offsets.pixel_count(), kNone) {
    for (int y = 0; y < offsets.height(); ++y) {
      for (int x = 0; x < offsets.width(); ++x) {
        const std::optional<std::size_t> target = target_of(x, y);
        if (!target) continue;
        int& best = best_[*target];
        const int index = y * offsets.width() + x;
        if (best == kNone || residual.data()[index] < residual.data()[best]) best = index;
      }
    }
  }

  /// Of the pixel that leads with the least residual to where (x, y) leads; empty if that is outside.
  std::span<const float> best_offset_to_target_of(int x, int y) const {
    const std::optional<std::size_t> target = target_of(x, y);
    return target ? offset_of(best_[*target]) : std::span<const float>();
  }

  /// Of the pixel that leads to (x, y) of the other image, or to its left or right, with the least residual;
  /// empty if none does: a surface that is wider there leaves gaps of a pixel.
  std::span<const float> best_offset_to(int x, int y) const {
    for (const int u : {x, x - 1, x + 1}) {
      if (u < 0 || u >= offsets_.width()) continue;
      const int best = best_[static_cast<std::size_t>(y) * offsets_.width() + u];
      if (best != kNone) return offset_of(best);
    }
    return {};
  }

 private:
  static constexpr int kNone = -1;

  /// The index of the pixel of the other image that (x, y) leads to; nothing if that is outside.
  std::optional<std::size_t> target_of(int x, int y) const {
    const std::span<const float> there = offsets_.pixel(x, y);
    const long u = std::lround(static_cast<float>(x) + there[0]);
    const long v = std::lround(static_cast<float>(y) + there[1]);
    if (u < 0 || v < 0 || u >= offsets_.width() || v >= offsets_.height()) return std::nullopt;
    return static_cast<std::size_t>(v) * offsets_.width() + u;
  }
  std::span<const float> offset_of(int index) const {
    return offsets_.data().subspan(2 * static_cast<std::size_t>(index), 2);
  }

  const Image& offsets_;
  std::vector<int> best_;  ///< for each pixel of the other image, the index of the one that leads there
};

}  // namespace

std::array<Image, 2> unique_offsets(const Image& offsets, const Image& residual) {
  constexpr float kTolerancePx = 1.0f;  // what one surface's offsets may differ by
  const Matches matches(offsets, residual);
  const Image nowhere(offsets.width(), offsets.height(), 2, kNowhere);
  std::array<Image, 2> unique{nowhere, nowhere};
  for_rows(offsets.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < offsets.width(); ++x) {
        const std::span<const float> own = offsets.pixel(x, y);
        if (const std::span<const float> best = matches.best_offset_to_target_of(x, y);
            !best.empty() && std::hypot(own[0] - best[0], own[1] - best[1]) <= kTolerancePx) {
          std::ranges::copy(own, unique[0].pixel(x, y).begin());
        }
        if (const std::span<const float> best = matches.best_offset_to(x, y); !best.empty()) {
          std::ranges::transform(best, unique[1].pixel(x, y).begin(), std::negate<>());
        }
      }
    }
  });
  return unique;
}

}  // namespace becalm::filter
