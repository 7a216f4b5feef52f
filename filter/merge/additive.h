#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/task.h"
#include "frame/frame.h"

namespace becalm::filter {

/// Additive AOVs: direct and indirect light, which add up to the beauty, and the light groups, which do too.
/// The filter carries them as RGBA images (A is 0) in the order of additive_images, with the beauty's
/// weights.
AovSet additive_aovs();

/// The additive AOVs of a frame: those of additive_aovs() that are in `used`, then the light groups, sorted
/// by name.
std::vector<Image*> additive_images(Frame& frame, const AovSet& used);
std::vector<const Image*> additive_images(const Frame& frame, const AovSet& used);

/// Packs the additive AOVs of a new frame for the chains. Where the beauty is not finite, a pixel becomes the
/// mean of its finite neighbours, as in pack_color; other non-finite values become 0 and are counted in the
/// report. Empty if the task has none. Throws Error(bad_input) if their number differs from the task's.
std::vector<Image> pack_additive(const Frame& frame, const FilterTask& task,
                                 std::span<const std::uint8_t> finite, FrameReport& report);

/// Adds the additive AOVs to `result`, a denoised frame: those of `denoised`, but unchanged from `frame` in
/// the pixels that `as_they_came` marks.
void unpack_additive(const NewFrame& frame, const FilterTask& task, const std::vector<Image>& denoised,
                     std::span<const std::uint8_t> as_they_came, Frame& result);

}  // namespace becalm::filter
