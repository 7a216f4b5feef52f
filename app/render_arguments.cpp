#include "app/render_arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <limits>
#include <numeric>
#include <span>

#include "app/eye_names.h"
#include "app/help.h"
#include "app/number_checks.h"
#include "app/parse_numbers.h"
#include "frame/error.h"
#include "frame/io/frame_range.h"
#include "tracer/sample_counts.h"

namespace becalm::app {
namespace {

void add_layers(CLI::App& parser, RenderCommand& command) {
  parser
      .add_option(
          "--aovs", command.aovs,
          "Layers besides the beauty: albedo, normal, depth, motion, variance, half_a, half_b, direct, "
          "indirect, object_id, material_id, light_groups (light.NAME for each group of the scene) joined by "
          "commas, all (but light groups, and of one sample no halves) or none (default: none)")
      ->option_text("LIST")
      ->group("Output");
  CLI::Option* type = parser.add_option("--type", command.type, "Type of the colours (default: half)")
                          ->check(CLI::IsMember({"half", "float"}))
                          ->option_text("half|float")
                          ->group("Output");
  // Former names, which scripts have.
  for (const std::string name : {"half", "float"}) {
    const std::string former = name == "half" ? "--half-float" : "--float";
    const auto take = [&command, type, name, former] {
      if (type->count() > 0)
        throw CLI::ValidationError(former, "is --type " + name + ", expected one of the two");
      command.type = name;
    };
    parser.add_flag_callback(former, take)->group("");
  }
}

void add_sampling(CLI::App& parser, RenderCommand& command) {
  parser
      .add_option("--spp", command.asked_spp,
                  "Samples per pixel (default: 8; the most with --noise-target: 256)")
      ->check(whole_number_from(1, tracer::kMostSamples))
      ->option_text("N")
      ->group("Rendering");
  parser
      .add_option(
          "--aov-spp", command.asked_aov_spp,
          "Samples per pixel of albedo, normal, depth, motion and ids where that is more than --spp; they "
          "cost little, since they trace no light, and edges denoise better (default: 16; --spp where the "
          "scene has a jitter_cycle)")
      ->check(whole_number_from(1, tracer::kMostSamples))
      ->option_text("N")
      ->group(more("Rendering"));
  parser
      .add_flag("--adaptive", command.adaptive,
                "With --denoise: --spp on average, more where errors are expected")
      ->group("Rendering");
  parser
      .add_option(
          "--noise-target", command.noise_target,
          "With --denoise: as many samples as bring the relative error that the filter expects of its "
          "result to X, such as 0.1 (the root of relMSE)")
      ->check(number_from(1e-4, 10.0))
      ->option_text("X")
      ->group("Rendering");
  parser
      .add_option("--time-budget", command.time_budget,
                  "With --denoise: the samples, and unless it names one the preset, that leave the least "
                  "error in so much time a frame: 20s, 1.5m")
      ->option_text("TIME")
      ->group("Rendering");
}

void add_images(CLI::App& parser, RenderCommand& command) {
  parser
      .add_flag(
          "--checkerboard", command.checkerboard,
          "Render every other pixel, the others in the next frame; becalm antialias --checkerboard makes "
          "them whole")
      ->group(more("Rendering"));
  parser.add_option("--size", command.size, "Image size in pixels (default: the scene's)")
      ->option_text("WxH")
      ->group("Rendering");
  parser
      .add_option(
          "--eye", command.eye,
          "Of a camera with an eye_separation: both eyes, as views of each file or for each eye a file "
          "of its own where -o has %V (left, right) or %v (l, r); or one of them (default: both)")
      ->check(CLI::IsMember({"both", "left", "right"}))
      ->option_text("both|left|right")
      ->group(more("Rendering"));
  parser
      .add_option("--seed", command.seed,
                  "Seed of the noise; different seeds give independent noise (default: 0)")
      ->check(whole_number_from(0, std::numeric_limits<std::uint32_t>::max()))
      ->option_text("N")
      ->group("Rendering");
}

void add_denoising(CLI::App& parser, RenderCommand& command) {
  parser
      .add_flag("--denoise{auto}", command.preset,
                "Denoise while rendering: draft, balanced (default) or final, speed against accuracy")
      ->option_text("[=PRESET]")
      ->group("Filter");
  parser
      .add_option("--keep-noisy", command.keep_noisy,
                  "With --denoise, also write the noisy frames, those that are read as context included, as "
                  "float with all that "
                  "the filter reads; --resume reads them instead of rendering again")
      ->option_text("PATTERN")
      ->group(more("Filter"));
  parser
      .add_option("--additive", command.filter.additive,
                  "auto denoises direct, indirect and light groups with the beauty's weights, so that they "
                  "still add up; none passes them on noisy (default: auto)")
      ->check(CLI::IsMember({"auto", "none"}))
      ->option_text("auto|none")
      ->group(more("Filter"));
  add_alpha_option(parser, command.filter);
  add_filter_options(parser, command.filter);
}

}  // namespace

void add_render_options(CLI::App& parser, RenderCommand& command) {
  parser.add_option("scene", command.scene, "The scene, a JSON file")->required()->option_text("SCENE.json");
  CLI::Option* output = add_output_options(parser, command.output, "the scene's");
  output->required(false);  // not with --debug-pixel; check_options_fit asks for it otherwise
  add_layers(parser, command);
  add_sampling(parser, command);
  add_images(parser, command);
  parser
      .add_option("--debug-pixel", command.debug_pixel,
                  "Print the path of one sample of the first frame, and write nothing; in place of -o")
      ->option_text("X,Y,SAMPLE")
      ->group(more("Rendering"))
      ->excludes(output);
  add_denoising(parser, command);
  add_running_options(parser, command.running);
  parser.footer(
      "Examples:\n"
      "  becalm render room.json -o 'out/room.####.exr' --frames 1-24 --spp 8 --aovs all\n"
      "  becalm render room.json -o 'out/room.####.exr' --spp 4 --denoise=final --resume\n"
      "What --set takes is listed by becalm denoise --help-settings.\n");
}

Size size_of(const RenderCommand& command, const tracer::SceneDescription& scene) {
  if (command.size.empty()) return {scene.film.width, scene.film.height};
  return parse_size(command.size);
}

std::vector<int> frames_of(const RenderCommand& command, const tracer::SceneDescription& scene) {
  if (!command.output.frames.empty()) return io::parse_frame_range(command.output.frames);
  std::vector<int> frames(static_cast<std::size_t>(scene.frames.last - scene.frames.first + 1));
  std::iota(frames.begin(), frames.end(), scene.frames.first);
  return frames;
}

int frame_step(const RenderCommand& command) {
  return command.output.frames.empty() ? 1 : io::frame_range_step(command.output.frames);
}

AskedAovs asked_aovs(const RenderCommand& command) {
  AskedAovs asked = parse_aovs(command.aovs);
  if (command.spp > 1) return asked;
  for (const Aov half : {Aov::half_a, Aov::half_b}) {
    if (!contains(asked.aovs, half)) continue;
    if (contains(asked.named, half)) {
      throw Error(ExitStatus::usage,
                  fmt::format("--aovs {}: expected at least 2 samples per pixel for {}, found 1",
                              command.aovs, info(half).name));
    }
    asked.aovs.reset(static_cast<std::size_t>(half));
  }
  return asked;
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

std::vector<Eye> eyes_of(const RenderCommand& command, const tracer::SceneDescription& scene) {
  if (scene.camera.has_two_eyes()) {
    if (command.eye == "both") return {Eye::left, Eye::right};
    return {command.eye == "left" ? Eye::left : Eye::right};
  }
  if (command.eye != "both") {
    throw Error(ExitStatus::usage,
                fmt::format("--eye {}: the scene's camera has no eye_separation", command.eye));
  }
  if (has_eye_field(command.output.pattern)) {
    throw Error(ExitStatus::usage,
                fmt::format("-o {}: has a field for the eye, and the scene's camera has no "
                            "eye_separation",
                            command.output.pattern));
  }
  return {Eye::centre};
}

void check_options_fit(const RenderCommand& command) {
  if (command.output.pattern.empty() && command.debug_pixel.empty()) {
    throw Error(ExitStatus::usage, "render: -o is required; see becalm render --help");
  }
  if (!command.preset.empty()) {
    if (command.checkerboard) {
      throw Error(
          ExitStatus::usage,
          "--checkerboard: its frames become whole by becalm antialias --checkerboard; --denoise cannot "
          "take them");
    }
    if (!command.time_budget.empty() && (command.noise_target || command.asked_spp)) {
      throw Error(ExitStatus::usage, fmt::format("--time-budget decides the samples: leave out {}",
                                                 command.noise_target ? "--noise-target" : "--spp"));
    }
    if (command.adaptive && command.noise_target) {
      throw Error(ExitStatus::usage,
                  "--noise-target decides the samples of every pixel: leave out --adaptive");
    }
    return;
  }
  const char* sampling = command.adaptive               ? "--adaptive"
                         : command.noise_target         ? "--noise-target"
                         : !command.time_budget.empty() ? "--time-budget"
                                                        : nullptr;
  if (sampling != nullptr) {
    throw Error(
        ExitStatus::usage,
        fmt::format("{} asks the filter where samples are needed, and there is no --denoise", sampling));
  }
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

void set_defaults(RenderCommand& command, const tracer::SceneDescription& scene) {
  constexpr int most_with_target = 256;
  command.spp = command.asked_spp.value_or(command.noise_target ? most_with_target : command.spp);
  // What is seen of jittered frames belongs to the positions of their samples.
  command.aov_spp =
      command.asked_aov_spp.value_or(scene.film.jitter.cycle > 0 ? command.spp : command.aov_spp);
  if (command.preset == kAutoPreset) command.preset = "balanced";
}

tracer::RenderOptions render_options(const RenderCommand& command, const Size& size) {
  tracer::RenderOptions options;
  options.width = size.width;
  options.height = size.height;
  options.spp = command.spp;
  options.aov_spp = command.aov_spp;
  options.seed = command.seed;
  options.checkerboard = command.checkerboard;
  return options;
}

}  // namespace becalm::app
