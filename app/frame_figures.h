#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "frame/image.h"

namespace becalm::app {

/// The figures of one frame against its reference; NaN where there is none, such as the temporal error of the
/// first frame.
struct FrameFigures {
  int frame = 0;
  double rel_mse = 0.0;
  double psnr_db = 0.0;
  double ssim = 0.0;
  double flip = 0.0;
  double temporal = 0.0;
  double energy = 0.0;
  std::size_t skipped = 0;  ///< pixels that are not finite in one of the images
};

/// What a limit bounds: from above, from below, or the absolute value from above.
enum class LimitKind { max, min, max_absolute };

/// One of FrameFigures, how it is printed and limited.
struct Figure {
  const char* title;
  const char* key;  ///< in JSON files
  double FrameFigures::*value;
  std::string (*format)(double);
  LimitKind limit;
  double most = std::numeric_limits<float>::max();  ///< that a limit can be
};

/// relMSE, PSNR, SSIM, FLIP, temporal error and energy, in the order of the printed table.
extern const std::array<Figure, 6> kFigures;

/// Whether the figure was measured: false only for a temporal error that is NaN, as that of a first frame is.
/// NaN in another figure means that no pixel was finite; it counts as a value and is beyond every limit.
bool has_value(const Figure& figure, const FrameFigures& figures);

/// Whether the value is beyond the limit, which NaN is: no pixel was finite.
bool is_beyond(LimitKind kind, double value, double limit);

/// The frames of a sequence that are beyond a limit.
struct BeyondLimit {
  const FrameFigures* worst = nullptr;  ///< of all frames that have a value, beyond the limit or not
  std::size_t failed = 0;
  std::size_t measured = 0;  ///< frames that have a value
};
BeyondLimit find_beyond(const Figure& figure, double limit, std::span<const FrameFigures> frames);

/// The images of one frame.
struct ComparedFrame {
  int frame = 0;
  Imath::V2i first{0, 0};               ///< where the first pixel lies
  Imath::V2d display_middle{0.0, 0.0};  ///< where files tell it; frames of another one show no common pixels
  Image test;
  Image reference;
  Image reference_b;     ///< empty where there is one reference
  Image reference_mean;  ///< of both references; empty where there is one

  /// For what has no form of two references: the one with the least noise.
  const Image& best_reference() const { return reference_b.empty() ? reference : reference_mean; }
  /// Whether both show the same pixels.
  bool is_where(const ComparedFrame& other) const {
    return first == other.first && test.same_shape(other.test);
  }
};

Image mean_image(const Image& a, const Image& b);

/// Mean over the frames; PSNR is a mean of decibels, as tables give it. NaN where no frame has a value.
FrameFigures mean_of(const std::vector<FrameFigures>& frames);

/// `before` is the frame measured before, or null; the temporal error is that of the pixels which both have,
/// and needs a frame `step` before `now`, the distance between the sequence's frames.
FrameFigures measure(const ComparedFrame& now, const ComparedFrame* before, int step = 1);

}  // namespace becalm::app
