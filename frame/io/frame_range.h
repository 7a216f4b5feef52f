#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::io {

/// More frames than any shot has: a longer range, or sequence with held frames, is taken for a typing error
/// and refused before it takes memory.
inline constexpr std::int64_t kMaxFrames = 1'000'000;

/// Frame numbers of a range such as `1-100`, `1-100x2`, `5`, `-3-4` or `1-10,20-30`, ascending and without
/// duplicates. Throws Error(usage) of `what`, such as an option, the text and what is wrong: a descending
/// range, a step below 1, no number, more than kMaxFrames.
std::vector<int> parse_frame_range(std::string_view text, std::string_view what = "frame range");

/// The step of such a text: N if all of its ranges are `A-BxN`, multiples of N apart, else 1. Throws as
/// parse_frame_range.
int frame_range_step(std::string_view text, std::string_view what = "frame range");

/// Range text that parse_frame_range turns into `frames` again, equal steps joined; `frames` ascends.
std::string format_frame_range(const std::vector<int>& frames);
/// Such text that frame_range_step, too, turns into `step` again, so that `render --frames` takes it for the
/// frames of the same shot. Frames that are no multiples of `step` apart are a list, whose step is 1.
std::string format_frame_range(const std::vector<int>& frames, int step);

}  // namespace becalm::io
