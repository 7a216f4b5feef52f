#pragma once

#include <array>
#include <string>
#include <string_view>

#include "frame/stereo.h"

namespace becalm::app {

/// The names of the views, as files have them, and of what takes the place of `%V` in a pattern.
inline constexpr std::array<std::string_view, 2> kEyeNames{"left", "right"};

/// The view's name; empty for a camera with one eye.
std::string name_of_eye(Eye eye);

/// Whether a view's name is that of the eye: the whole word or its first letter, whatever the case.
bool is_eye(std::string_view view, Eye eye);

/// Whether two views are those of a pair, in this order or the other.
bool are_eyes(std::string_view first, std::string_view second);

/// Whether the pattern has a field for the eye, as Nuke writes it: `%V` for `left` and `right`, `%v` for `l`
/// and `r`.
bool has_eye_field(std::string_view pattern);

/// Throws Error(usage) for a pattern with a field for the eye, where a command takes none.
void refuse_eye_field(std::string_view pattern);

/// The pattern of an eye (0 the left one, 1 the right one).
std::string pattern_of_eye(std::string_view pattern, std::size_t eye);

}  // namespace becalm::app
