#include "app/given_jitter.h"

#include <fmt/format.h>

#include <charconv>
#include <numeric>
#include <string_view>

#include "frame/error.h"
#include "tracer/sampling/jitter.h"

namespace becalm::app {

std::optional<FrameJitter> given_jitter(const std::string& text, int frame) {
  if (text == "none") return std::nullopt;
  constexpr std::string_view halton = "halton:";
  constexpr std::uint32_t most = 1'000'000;
  tracer::Jitter jitter;
  const char* const end = text.data() + text.size();
  const bool named = text.starts_with(halton);
  const auto parsed = std::from_chars(named ? text.data() + halton.size() : end, end, jitter.cycle);
  if (!named || parsed.ec != std::errc() || parsed.ptr != end || jitter.cycle < 1 || jitter.cycle > most) {
    throw Error(ExitStatus::usage,
                fmt::format("--jitter {}: expected auto, none or halton:N with N from 1 to {}", text, most));
  }
  return FrameJitter{.positions_px = {jitter.point(frame, 1, 0) - Imath::V2f(0.5f)}};
}

Parity given_checkerboard(const std::string& text, int frame, const Imath::V2i& first) {
  const bool is_odd = (text == "odd") != (((frame + first.x + first.y) & 1) != 0);
  return is_odd ? Parity::odd : Parity::even;
}

Scale given_scale(const std::string& text) {
  const Error refused(
      ExitStatus::usage,
      fmt::format("--scale {}: expected a number from 1 to 4 of at most three decimals, such as "
                  "1.5, or a fraction, such as 3/2, whose denominator is at most {}",
                  text, Scale::kMostDenominator));
  const char* const end = text.data() + text.size();
  const auto digits = [&](const char* from, int& number) {
    const auto parsed = std::from_chars(from, end, number);
    if (parsed.ec != std::errc() || *from == '-') throw refused;
    return parsed.ptr;
  };
  Scale scale;
  const char* next = digits(text.data(), scale.numerator);
  if (next != end && *next == '/') {
    next = digits(next + 1, scale.denominator);
  } else if (next != end && *next == '.' && end - next > 1 && end - next <= 4) {
    int decimals = 0;
    for (const char* digit = next + 1; digit != end; ++digit) scale.denominator *= 10;
    if (scale.numerator > 4) throw refused;
    next = digits(next + 1, decimals);
    scale.numerator = scale.numerator * scale.denominator + decimals;
  }
  const bool fits = scale.denominator >= 1 && scale.denominator <= Scale::kMostDenominator &&
                    scale.numerator >= scale.denominator && scale.numerator / 4 <= scale.denominator &&
                    scale.numerator <= 4 * scale.denominator;
  if (next != end || !fits) throw refused;
  const int divisor = std::gcd(scale.numerator, scale.denominator);
  return {scale.numerator / divisor, scale.denominator / divisor};
}

}  // namespace becalm::app
