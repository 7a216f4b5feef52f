#include "app/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include "app/byte_size.h"
#include "app/help.h"
#include "app/number_checks.h"
#include "app/setting_text.h"
#include "filter/antialias/antialias_settings.h"
#include "filter/tiles/build_within.h"
#include "frame/error.h"
#include "frame/io/exr.h"
#include "tracer/snapshot/intersect.h"

namespace becalm::app {

CLI::Option* add_output_options(CLI::App& command, OutputOptions& options,
                                const std::string& frames_default) {
  CLI::Option* output = command
                            .add_option("-o,--output", options.pattern,
                                        "Where to write: an EXR name with a frame field such as ####")
                            ->required()
                            ->option_text("PATTERN")
                            ->group("Output");
  command
      .add_option("--frames", options.frames,
                  fmt::format("Frames to write: 1-24, 1-100x2, 5, 1-10,20-30; negative ones as --frames=-3-4 "
                              "(default: {})",
                              frames_default))
      ->option_text("RANGE")
      ->group("Output");
  command
      .add_flag("--resume", options.resume, "Keep the frames that are there, after checking their settings")
      ->group("Output");
  command
      .add_flag("--overwrite", options.overwrite,
                "Replace files that this command did not write, too; those that it wrote are replaced anyway")
      ->group(more("Output"));
  return output;
}

void add_threads_option(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Processor threads to use (default: all)")
      ->check(whole_number_from(1, 4096))
      ->option_text("N")
      ->group("Running");
}

void add_running_options(CLI::App& command, RunningOptions& options) {
  add_threads_option(command, options.threads);
  command
      .add_flag("--reproducible", options.reproducible,
                "Equal bytes on x86-64 processors that have FMA, with the same libraries: Embree, oneDNN and "
                "the software device, which is then "
                "taken unless --device names another, use no instructions beyond SSE4.2; takes about 10 % "
                "longer")
      ->group(more("Running"));
  command.add_flag("--profile", options.profile, "At the end, tell where time and memory went")
      ->group(more("Running"));
  CLI::Option* quiet = command.add_flag("-q,--quiet", options.quiet, "No progress; warnings and errors stay")
                           ->group("Running");
  command.add_flag("-v,--verbose", options.verbose, "Also tell layers, device, tiles, histories and files")
      ->excludes(quiet)
      ->group("Running");
  command
      .add_option_function<std::string>(
          "--progress", [](const std::string&) {},  // main has read it before all others
          "json: one object a line on standard error, for farm managers; its events are frame, progress, "
          "message, end and error (default: text)")
      ->check(CLI::IsMember({"text", "json"}))
      ->option_text("text|json")
      ->group(more("Running"));
}

namespace {

/// Libraries otherwise take the widest instructions of the processor, whose sums and products round
/// differently. SSE4.2 is what becalm itself is compiled for.
void pin_instruction_sets() {
  tracer::limit_to_sse42();
  // Both have no other way to be told, and read it when they are first used.
  setenv("ONEDNN_MAX_CPU_ISA", "SSE41", /*overwrite=*/1);
  setenv("LP_NATIVE_VECTOR_WIDTH", "128", /*overwrite=*/1);
}

}  // namespace

void apply(const RunningOptions& running, FilterOptions& filter) {
  if (!running.reproducible) return;
  pin_instruction_sets();
  if (filter.device.empty()) filter.device = "llvmpipe";
}

void add_alpha_option(CLI::App& command, FilterOptions& options) {
  command
      .add_option("--alpha", options.alpha,
                  "keep passes alpha on as it came; denoise smooths it where it looks noisy, as under motion "
                  "blur and depth of field; clean hair looks noisy too (default: keep)")
      ->check(CLI::IsMember({"keep", "denoise"}))
      ->option_text("keep|denoise")
      ->group(more("Filter"));
}

void add_filter_options(CLI::App& command, FilterOptions& options) {
  command
      .add_option("--set", options.assignments,
                  "Change a setting of the preset; repeatable, the last of a key holds")
      ->option_text("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false)
      ->group("Filter");
  command
      .add_option(
          "--segment", options.segment,
          "Frame numbers that are filtered together, forward and backward in time; a forward filter has no "
          "segments unless asked (default: 32)")
      ->check(whole_number_from(1, 100000))
      ->option_text("B")
      ->group(more("Filter"));
  command
      .add_option("--warmup", options.warmup,
                  "Frame numbers before and after a segment that its history begins with (default: 8)")
      ->check(whole_number_from(0, 100000))
      ->option_text("W")
      ->group(more("Filter"));
  command
      .add_option(
          "--context", options.context,
          "Frames that may be read besides those of --frames, so that it does not matter how a sequence is "
          "cut "
          "into jobs: none or a range such as 1-96 (default: all there are; none where history is unbounded)")
      ->option_text("none|RANGE")
      ->group(more("Filter"));
  command
      .add_option("--cuts", options.cuts,
                  "Where new shots begin, so that nothing is carried over: auto finds out, none, or their "
                  "first frames "
                  "such as 12,80 (default: auto)")
      ->option_text("auto|none|LIST")
      ->group(more("Filter"));
  command
      .add_flag(
          "--diagnostics", options.diagnostics,
          "Write what the filter decided as layers: flow, error_mask, sample_count, bias, gain; denoising "
          "also residual, remaining_variance, stereo_weight (pairs of eyes) and the merged noisy layers: "
          "accumulated, accumulated_albedo, ...")
      ->group(more("Filter"));
  command.add_option("--device", options.device, "Vulkan device (default: a hardware GPU if there is one)")
      ->option_text("N|NAME")
      ->group(more("Running"));
  command
      .add_option(
          "--memory", options.memory,
          "Device memory that the filter may take: 512M, 2G, 1.5G (default: what the device has); denoising "
          "cuts larger frames into tiles, which the results do not show")
      ->option_text("SIZE")
      ->group(more("Running"));
  command
      .add_flag("--validate", options.validate,
                "Run under the Vulkan validation layers; any message is an error")
      ->group(more("Running"));
}

filter::Settings resolve_settings(const std::string& preset, const FilterOptions& options) {
  filter::Settings settings = filter::preset(preset);
  for (const std::string& assignment : options.assignments) filter::set(settings, assignment);
  return settings;
}

gpu::DeviceOptions device_options(const FilterOptions& options) {
  return {.select = options.device, .validation = options.validate};
}

MemoryLimit::MemoryLimit(const FilterOptions& options)
    : most_(std::numeric_limits<std::uint64_t>::max()), share_(options.memory_share) {
  if (options.memory.empty()) return;
  const std::optional<std::uint64_t> bytes = parse_bytes(options.memory);
  if (!bytes) {
    throw Error(
        ExitStatus::usage,
        fmt::format("--memory {}: expected a size with its unit, such as 512M or 1.5G", options.memory));
  }
  most_ = *bytes;
}

std::uint64_t MemoryLimit::bytes_of(const gpu::Device& device) const {
  const std::uint64_t bytes = std::min(most_, filter::usable_bytes(device));
  return static_cast<std::uint64_t>(share_ * static_cast<double>(bytes));
}

AovSet diagnostics_of(const FilterOptions& options) {
  AovSet diagnostics;
  for (const AovInfo& entry : kAovTable) {
    diagnostics.set(static_cast<std::size_t>(entry.aov), options.diagnostics && entry.diagnostic);
  }
  return diagnostics;
}

namespace {

/// In lines of at most 80 characters, each behind `indent` blanks.
std::string indented(const std::string& text, std::size_t indent) {
  const std::string blanks(indent, ' ');
  std::string lines = blanks;
  for (const char c : wrap(text, 80)) lines += c == '\n' ? c + blanks : std::string(1, c);
  return lines;
}

/// `text_of` names the settings of a preset.
std::string settings_help(std::span<const filter::SettingInfo> table,
                          std::span<const std::string_view> presets,
                          const std::function<std::string(std::string_view)>& text_of) {
  constexpr std::size_t indent = 25;
  std::map<std::string_view, std::string> settings;
  for (const std::string_view name : presets) settings.emplace(name, text_of(name));
  std::string text = "Settings that --set changes, and what the presets have:\n";
  for (const filter::SettingInfo& setting : table) {
    text += fmt::format("  {:<20} {}\n{}\n{}", setting.key, setting.type,
                        indented(std::string(setting.help), indent), std::string(indent, ' '));
    const auto value_in = [&](std::string_view name) {
      return setting_value(settings.at(name), std::string(setting.key));
    };
    const std::string first = value_in(presets.front());
    if (std::ranges::all_of(presets, [&](std::string_view name) { return value_in(name) == first; })) {
      text += fmt::format("all: {}", first);
    } else {
      for (const std::string_view name : presets) {
        text += fmt::format("{}{}: {}", name == presets.front() ? "" : "; ", name, value_in(name));
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string denoise_settings_help() {
  return settings_help(filter::settings_table(), filter::kPresets,
                       [](std::string_view name) { return filter::to_string(filter::preset(name)); });
}

std::string antialias_settings_help() {
  return settings_help(
      filter::antialias_settings_table(), filter::kAntialiasPresets,
      [](std::string_view name) { return filter::to_string(filter::antialias_preset(name)); });
}

void check_validation(const gpu::Device& device) {
  const auto& messages = device.validation_messages();
  if (messages.empty()) return;
  throw gpu::DeviceError(fmt::format("{} message(s) of the Vulkan validation layer, the first: {}",
                                     messages.size(), messages.front()));
}

ThreadLimit::ThreadLimit(int threads) {
  if (threads == 0) return;
  control_.emplace(tbb::global_control::max_allowed_parallelism, threads);
  io::set_exr_threads(threads);
  // The software device has no other way to be told.
  setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), /*overwrite=*/1);
}

}  // namespace becalm::app
