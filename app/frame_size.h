#pragma once

#include <string>

namespace becalm::app {

inline constexpr int kLargestSide = 65536;

/// Of a rendered frame, in pixels.
struct Size {
  int width = 0;
  int height = 0;
};
/// `WIDTHxHEIGHT` of --size. Throws Error(usage) naming the text and what was expected.
Size parse_size(const std::string& text);

}  // namespace becalm::app
