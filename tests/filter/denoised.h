#pragma once

#include "filter/sequence/sequence_filter.h"

namespace becalm::filter {

/// What a filter makes of one frame.
struct Denoised {
  Frame frame;  ///< beauty, remaining variance, additive AOVs, and the requested diagnostics
  FrameReport report;
};

/// Runs a wanted forward step.
inline Denoised denoise_frame(SequenceFilter& filter, const Frame& frame, bool new_history = false) {
  Denoised denoised;
  denoised.frame = *filter.run({.frame = frame.number(), .new_history = new_history}, frame, denoised.report);
  return denoised;
}

}  // namespace becalm::filter
