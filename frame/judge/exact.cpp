#include "frame/judge/exact.h"

#include <Imath/half.h>
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace becalm::judge {
namespace {

/// Integers in the order of the floats (or halves) that have these bits: neighbours differ by one, and both
/// zeros are 0.
std::int64_t ordered(std::uint32_t bits, std::uint32_t sign) {
  return (bits & sign) != 0 ? -static_cast<std::int64_t>(bits & (sign - 1)) : static_cast<std::int64_t>(bits);
}

std::uint64_t distance(std::int64_t a, std::int64_t b) {
  return static_cast<std::uint64_t>(a > b ? a - b : b - a);
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

std::optional<std::uint64_t> ulps_between(float a, float b, Stored stored) {
  if (std::isnan(a) || std::isnan(b)) return std::nullopt;
  if (stored == Stored::half) {
    constexpr std::uint32_t sign = 0x8000u;
    return distance(ordered(Imath::half(a).bits(), sign), ordered(Imath::half(b).bits(), sign));
  }
  constexpr std::uint32_t sign = 0x80000000u;
  return distance(ordered(std::bit_cast<std::uint32_t>(a), sign),
                  ordered(std::bit_cast<std::uint32_t>(b), sign));
}

std::uint64_t rank(const Difference& difference) {
  return difference.ulps.value_or(std::numeric_limits<std::uint64_t>::max());
}

std::string describe(const Difference& difference, Stored stored) {
  std::string text = fmt::format("pixel {},{} channel {}: {:.9g} instead of {:.9g}", difference.x,
                                 difference.y, difference.channel, difference.test, difference.reference);
  if (difference.ulps) {
    text += fmt::format(", {} ulps of {}", *difference.ulps, stored == Stored::half ? "half" : "float");
  }
  return text;
}

}  // namespace

ExactResult compare_exactly(const Image& test, const Image& reference, Stored stored) {
  if (!test.same_shape(reference)) {
    throw std::invalid_argument(fmt::format(
        "an exact comparison was asked of {}x{} pixels of {} channels with {}x{} of {}", test.width(),
        test.height(), test.channels(), reference.width(), reference.height(), reference.channels()));
  }
  ExactResult result{.stored = stored, .differing_pixels = 0, .first = {}, .largest = {}};
  for (int y = 0; y < test.height(); ++y) {
    for (int x = 0; x < test.width(); ++x) {
      bool differs = false;
      for (int c = 0; c < test.channels(); ++c) {
        Difference difference{.x = x,
                              .y = y,
                              .channel = c,
                              .test = test.at(x, y, c),
                              .reference = reference.at(x, y, c),
                              .ulps = {}};
        if (same_bits(difference.test, difference.reference)) continue;
        differs = true;
        difference.ulps = ulps_between(difference.test, difference.reference, stored);
        if (!result.first) result.first = difference;
        if (!result.largest || rank(difference) > rank(*result.largest)) result.largest = difference;
      }
      if (differs) ++result.differing_pixels;
    }
  }
  return result;
}

std::string describe(const ExactResult& result) {
  if (result.passed()) return "all pixels are equal, bit for bit";
  std::string text = fmt::format("{} pixels differ; first {}", result.differing_pixels,
                                 describe(*result.first, result.stored));
  if (rank(*result.largest) > rank(*result.first))
    text += fmt::format("; largest {}", describe(*result.largest, result.stored));
  return text;
}

}  // namespace becalm::judge
