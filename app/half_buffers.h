#pragma once

#include <optional>
#include <string>

#include "frame/io/exr.h"
#include "frame/io/sequence.h"

namespace becalm::app {

/// The sequence with the other half of the samples, by Altus' names: `shot.b1.####.exr` for
/// `shot.b0.####.exr`, and the reverse. Nothing if `first` is not named so or no file of the other is on
/// disk.
std::optional<io::SequencePattern> find_other_half(const io::SequencePattern& first);

/// Makes one frame of two halves: beauty, albedo, normal and additive AOVs are the halves' means, half_a and
/// half_b their beauties; the rest stays the first one's. A variance, which would be that of a half, is left
/// out. Views of stereo files are joined in their order. Throws Error(bad_input) naming `second_path` unless
/// both have the same views, size and AOVs.
void join_halves(io::LoadedFrame& first, const io::LoadedFrame& second, const std::string& second_path);

}  // namespace becalm::app
