#pragma once

#include <OpenEXR/ImfPixelType.h>

#include <cstddef>
#include <span>

namespace becalm::io {

/// Reads values.size() consecutive samples of a file. `samples` need not be aligned.
void from_samples(Imf::PixelType type, const char* samples, std::span<float> values);

/// Writes the values as consecutive samples. Halves are rounded to the nearest, and finite values beyond
/// their range become the largest; UINT is rounded too, within its range, and 0 for NaN. Returns how many
/// values were beyond the range of halves.
std::size_t to_samples(Imf::PixelType type, std::span<const float> values, char* samples);

}  // namespace becalm::io
