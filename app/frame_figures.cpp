#include "app/frame_figures.h"

#include <Imath/ImathBox.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/flip.h"
#include "frame/metrics.h"

namespace becalm::app {
namespace {

double limited(LimitKind kind, double value) {
  return kind == LimitKind::max_absolute ? std::abs(value) : value;
}

Imath::Box2i window_of(const ComparedFrame& frame) {
  return {frame.first, frame.first + Imath::V2i(frame.test.width() - 1, frame.test.height() - 1)};
}

/// The pixels of the image plane that both frames show; empty if none.
Imath::Box2i common_window(const ComparedFrame& a, const ComparedFrame& b) {
  if (a.display_middle != b.display_middle) return {};
  const Imath::Box2i of_a = window_of(a), of_b = window_of(b);
  if (!of_a.intersects(of_b)) return {};
  return {{std::max(of_a.min.x, of_b.min.x), std::max(of_a.min.y, of_b.min.y)},
          {std::min(of_a.max.x, of_b.max.x), std::min(of_a.max.y, of_b.max.y)}};
}

/// The part of an image, whose first pixel is `first` of the image plane, within `window`.
Image cropped(const Image& image, const Imath::V2i& first, const Imath::Box2i& window) {
  if (image.empty()) return {};
  const Imath::V2i size = window.size() + Imath::V2i(1);
  Image part(size.x, size.y, image.channels());
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const Imath::V2i from = window.min - first + Imath::V2i(x, y);
      std::ranges::copy(image.pixel(from.x, from.y), part.pixel(x, y).begin());
    }
  }
  return part;
}

/// What the temporal error takes of a frame, within `window`.
ComparedFrame cropped(const ComparedFrame& frame, const Imath::Box2i& window) {
  return {.frame = frame.frame,
          .first = window.min,
          .display_middle = frame.display_middle,
          .test = cropped(frame.test, frame.first, window),
          .reference = cropped(frame.reference, frame.first, window),
          .reference_b = cropped(frame.reference_b, frame.first, window),
          .reference_mean = {}};
}

double temporal(const ComparedFrame& now, const ComparedFrame& before) {
  if (!now.is_where(before)) {
    const Imath::Box2i common = common_window(now, before);
    if (common.isEmpty()) return std::numeric_limits<double>::quiet_NaN();
    return temporal(cropped(now, common), cropped(before, common));
  }
  if (now.reference_b.empty())
    return temporal_error(now.test, before.test, now.reference, before.reference).value;
  return temporal_error(now.test, before.test, now.reference, before.reference, now.reference_b,
                        before.reference_b)
      .value;
}

}  // namespace

const std::array<Figure, 6> kFigures{
    Figure{"relMSE", "relmse", &FrameFigures::rel_mse, [](double v) { return fmt::format("{:.4e}", v); },
           LimitKind::max},
    Figure{"PSNR dB", "psnr", &FrameFigures::psnr_db, [](double v) { return fmt::format("{:.2f}", v); },
           LimitKind::min},
    Figure{"SSIM", "ssim", &FrameFigures::ssim, [](double v) { return fmt::format("{:.4f}", v); },
           LimitKind::min, 1.0},
    Figure{"FLIP", "flip", &FrameFigures::flip, [](double v) { return fmt::format("{:.4f}", v); },
           LimitKind::max, 1.0},
    Figure{"temporal", "temporal", &FrameFigures::temporal, [](double v) { return fmt::format("{:.4e}", v); },
           LimitKind::max},
    Figure{"energy", "energy", &FrameFigures::energy,
           [](double v) { return fmt::format("{:+.3f} %", v * 100.0); }, LimitKind::max_absolute},
};

bool has_value(const Figure& figure, const FrameFigures& figures) {
  return figure.value != &FrameFigures::temporal || !std::isnan(figures.temporal);
}

bool is_beyond(LimitKind kind, double value, double limit) {
  return kind == LimitKind::min ? !(value >= limit) : !(limited(kind, value) <= limit);
}

BeyondLimit find_beyond(const Figure& figure, double limit, std::span<const FrameFigures> frames) {
  BeyondLimit found;
  for (const FrameFigures& frame : frames) {
    if (!has_value(figure, frame)) continue;
    const double value = frame.*figure.value;
    ++found.measured;
    found.failed += is_beyond(figure.limit, value, limit) ? 1 : 0;
    const double worst = found.worst == nullptr ? 0.0 : found.worst->*figure.value;
    const bool is_worst = !std::isnan(worst) && is_beyond(figure.limit, value, limited(figure.limit, worst));
    if (found.worst == nullptr || is_worst) found.worst = &frame;
  }
  return found;
}

Image mean_image(const Image& a, const Image& b) {
  Image mean = a;
  for (std::size_t i = 0; i < mean.data().size(); ++i) mean.data()[i] = 0.5f * (a.data()[i] + b.data()[i]);
  return mean;
}

FrameFigures mean_of(const std::vector<FrameFigures>& frames) {
  FrameFigures mean;
  for (const Figure& figure : kFigures) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const FrameFigures& figures : frames) {
      if (!has_value(figure, figures)) continue;
      sum += figures.*figure.value;
      ++count;
    }
    mean.*figure.value =
        count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
  }
  for (const FrameFigures& figures : frames) mean.skipped += figures.skipped;
  return mean;
}

FrameFigures measure(const ComparedFrame& now, const ComparedFrame* before, int step) {
  const bool two = !now.reference_b.empty();
  const Measured error =
      two ? rel_mse(now.test, now.reference, now.reference_b) : rel_mse(now.test, now.reference);
  FrameFigures figures{.frame = now.frame,
                       .rel_mse = error.value,
                       .temporal = std::numeric_limits<double>::quiet_NaN(),
                       .skipped = error.skipped};
  if (two) {
    figures.psnr_db = psnr(now.test, now.reference, now.reference_b, 1.0).value;
    figures.ssim = ssim(now.test, now.reference, now.reference_b).value;
    figures.energy = energy(now.test, now.reference, now.reference_b).value;
  } else {
    figures.psnr_db = psnr(now.test, now.reference).value;
    figures.ssim = ssim(now.test, now.reference).value;
    figures.energy = energy(now.test, now.reference).value;
  }
  figures.flip = flip(now.test, now.best_reference()).value;
  if (before != nullptr && before->frame == now.frame - step) figures.temporal = temporal(now, *before);
  return figures;
}

}  // namespace becalm::app
