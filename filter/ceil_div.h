#pragma once

namespace becalm::filter {

/// a / b, rounded up, of positive numbers.
constexpr int ceil_div(int a, int b) {
  return (a + b - 1) / b;
}

}  // namespace becalm::filter
