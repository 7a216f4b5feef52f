#include "app/frame_size.h"

#include <fmt/format.h>

#include <array>
#include <span>

#include "app/parse_numbers.h"
#include "frame/error.h"

namespace becalm::app {

Size parse_size(const std::string& text) {
  std::array<int, 2> sides{};
  const auto fits = [](int side) { return side >= 1 && side <= kLargestSide; };
  if (!parse_numbers(text, 'x', std::span<int>(sides)) || !fits(sides[0]) || !fits(sides[1])) {
    throw Error(
        ExitStatus::usage,
        fmt::format("--size {}: expected WIDTHxHEIGHT, such as 640x360, each 1 to {}", text, kLargestSide));
  }
  return {sides[0], sides[1]};
}

}  // namespace becalm::app
