#pragma once

#include <string_view>

namespace becalm::io {

/// Whether a part or layer of this name, in lower case, is the beauty only where there is no other: summands
/// of it, shadows, masks, denoised pictures.
bool is_seldom_beauty(std::string_view part);

/// Whether bare channels R, G and B of a part of this name, in lower case, are no colour: ids and positions.
bool is_no_colour(std::string_view part);

}  // namespace becalm::io
