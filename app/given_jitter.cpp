#include "app/given_jitter.h"

#include <fmt/format.h>

#include <charconv>
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

}  // namespace becalm::app
