#pragma once

#include <cstdint>
#include <vector>

#include "frame/frame.h"

namespace becalm::filter {

/// Throws Error(bad_input) unless the frame says which of its pixels hold samples (Frame::checkerboard).
void require_checkerboard(const Frame& frame);

/// Copies all AOVs but the beauty to pixels without samples, each from one of its four neighbours: the one of
/// least depth, if there is depth.
void fill_holes(Frame& frame, Parity parity);

/// Marks pixels without samples as 0, in rows of `width`.
void leave_holes(Parity parity, int width, std::vector<std::uint8_t>& counts);
/// Marks them as 1.
void close_holes(Parity parity, int width, std::vector<std::uint8_t>& counts);

}  // namespace becalm::filter
