#include "app/render_arguments.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>

#include "frame/error.h"
#include "frame/io/sequence.h"

namespace becalm::app {
namespace {

constexpr int kLargestSide = 65536;
/// The word of --aovs for one layer a light group.
constexpr std::string_view kLightGroups = "light_groups";

/// Reads exactly `numbers.size()` integers with `separator` between them.
template <class Integer>
bool parse_numbers(std::string_view text, char separator, std::span<Integer> numbers) {
  const char* position = text.data();
  const char* end = text.data() + text.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0 && (position == end || *position++ != separator)) return false;
    const auto parsed = std::from_chars(position, end, numbers[i]);
    if (parsed.ec != std::errc()) return false;
    position = parsed.ptr;
  }
  return position == end;
}

bool made_by_tracer(const AovInfo& entry) {
  return !entry.diagnostic && entry.aov != Aov::beauty;
}

}  // namespace

Size size_of(const RenderCommand& command, const tracer::SceneDescription& scene) {
  if (command.size.empty()) return {scene.film.width, scene.film.height};
  std::array<int, 2> sides{};
  const auto fits = [](int side) { return side >= 1 && side <= kLargestSide; };
  if (!parse_numbers(command.size, 'x', std::span<int>(sides)) || !fits(sides[0]) || !fits(sides[1])) {
    throw Error(ExitStatus::usage,
                fmt::format("--size {}: expected WIDTHxHEIGHT, such as 640x360, each 1 to {}", command.size,
                            kLargestSide));
  }
  return {sides[0], sides[1]};
}

std::vector<int> frames_of(const RenderCommand& command, const tracer::SceneDescription& scene) {
  if (!command.output.frames.empty()) return io::parse_frame_range(command.output.frames);
  std::vector<int> frames(static_cast<std::size_t>(scene.frames.last - scene.frames.first + 1));
  std::iota(frames.begin(), frames.end(), scene.frames.first);
  return frames;
}

AskedAovs parse_aovs(const std::string& text) {
  AovSet all;
  std::string names;
  for (const AovInfo& entry : kAovTable) {
    if (!made_by_tracer(entry)) continue;
    all.set(static_cast<std::size_t>(entry.aov));
    names += fmt::format("{}, ", entry.name);
  }
  if (text == "all") return {all, false};
  AskedAovs chosen;
  if (text == "none") return chosen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, comma - begin);
    begin = comma + 1;
    if (name == kLightGroups) {
      chosen.light_groups = true;
      continue;
    }
    const std::optional<Aov> aov = find_aov(name);
    if (!aov || info(*aov).diagnostic) {
      throw Error(ExitStatus::usage,
                  fmt::format("--aovs: no AOV '{}'{}; expected some of {}{}, all or none", name,
                              aov ? " of the tracer (the filter's come with --diagnostics)" : "", names,
                              kLightGroups));
    }
    chosen.aovs.set(static_cast<std::size_t>(*aov), *aov != Aov::beauty);
  }
  return chosen;
}

tracer::PixelSample parse_pixel_sample(const std::string& text) {
  std::array<std::uint32_t, 3> numbers{};
  if (!parse_numbers(text, ',', std::span<std::uint32_t>(numbers)) || numbers[0] >= kLargestSide ||
      numbers[1] >= kLargestSide) {
    throw Error(ExitStatus::usage,
                fmt::format("--debug-pixel {}: expected X,Y,SAMPLE, such as 12,30,0", text));
  }
  return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1]), numbers[2]};
}

void check_options_fit(const RenderCommand& command) {
  if (command.output.pattern.empty() && command.debug_pixel.empty()) {
    throw Error(ExitStatus::usage, "render: -o is required; see becalm render --help");
  }
  if (!command.preset.empty()) return;
  const char* unused = !command.keep_noisy.empty()           ? "--keep-noisy"
                       : !command.filter.assignments.empty() ? "--set"
                       : command.filter.diagnostics          ? "--diagnostics"
                       : !command.filter.device.empty()      ? "--device"
                       : !command.filter.memory.empty()      ? "--memory"
                       : !command.filter.context.empty()     ? "--context"
                       : command.filter.cuts != "auto"       ? "--cuts"
                       : command.filter.alpha != "keep"      ? "--alpha"
                       : command.filter.additive != "auto"   ? "--additive"
                       : command.filter.segment              ? "--segment"
                       : command.filter.warmup               ? "--warmup"
                       : command.filter.validate             ? "--validate"
                                                             : nullptr;
  if (unused == nullptr) return;
  throw Error(ExitStatus::usage, fmt::format("{} says how to denoise, and there is no --denoise", unused));
}

std::string format_aovs(const AskedAovs& asked) {
  std::string text;
  for (const AovInfo& entry : kAovTable) {
    if (!contains(asked.aovs, entry.aov)) continue;
    text += fmt::format("{}{}", text.empty() ? "" : ",", entry.name);
  }
  if (asked.light_groups) text += fmt::format("{}{}", text.empty() ? "" : ",", kLightGroups);
  return text.empty() ? "none" : text;
}

tracer::RenderOptions render_options(const RenderCommand& command, const Size& size) {
  tracer::RenderOptions options;
  options.width = size.width;
  options.height = size.height;
  options.spp = command.spp;
  options.aov_spp = command.aov_spp;
  options.seed = command.seed;
  return options;
}

}  // namespace becalm::app
