#pragma once

#include <span>
#include <string>
#include <string_view>

namespace becalm::app {

/// The name that a mistyped one was probably meant to be: one that it begins, or that few letters inserted,
/// left out, replaced or exchanged with their neighbours make of it. Empty if none is near.
std::string nearest_name(std::string_view typed, std::span<const std::string> names);

}  // namespace becalm::app
