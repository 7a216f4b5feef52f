#pragma once

#include <cstdint>
#include <vector>

#include "frame/frame.h"

namespace becalm::filter {

/// Throws Error(bad_input) for a frame that does not tell its pixels.
void require_checkerboard(const Frame& frame);

/// Gives pixels without samples the AOVs, but for the beauty, of a neighbour: of the closest, if there is
/// depth.
void fill_holes(Frame& frame, Parity parity);

/// Marks pixels without samples as 0, in rows of `width`.
void leave_holes(Parity parity, int width, std::vector<std::uint8_t>& counts);
/// Marks them as 1.
void close_holes(Parity parity, int width, std::vector<std::uint8_t>& counts);

}  // namespace becalm::filter
