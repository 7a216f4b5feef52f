#pragma once

namespace becalm::filter {

/// a / b rounded up, for positive a and b.
constexpr int ceil_div(int a, int b) {
  return (a + b - 1) / b;
}

}  // namespace becalm::filter
