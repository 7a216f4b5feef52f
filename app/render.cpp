// becalm render: the tracer, and with --denoise the filter behind it, from a scene to a sequence of EXR
// files.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <memory>
#include <numeric>
#include <optional>

#include "app/cancel.h"
#include "app/command.h"
#include "app/filter_step.h"
#include "app/options.h"
#include "app/outputs.h"
#include "app/profile.h"
#include "app/progress.h"
#include "app/scene_hash.h"
#include "app/stage.h"
#include "app/writing.h"
#include "frame/io/exr.h"
#include "frame/io/sequence.h"
#include "tracer/render.h"
#include "tracer/scene/load.h"

namespace becalm::app {
namespace {

constexpr int kLargestSide = 65536;

struct RenderCommand {
  std::string scene;
  OutputOptions output;
  FilterOptions filter;
  int spp = 8;
  std::string size;
  std::uint32_t seed = 0;
  std::string aovs = "none";
  bool float_colors = false;
  std::string preset;  ///< of --denoise; empty: no filter
  std::string keep_noisy;
};

AovSet parse_aovs(const std::string& text) {
  AovSet chosen;
  if (text == "none") return chosen;
  for (const AovInfo& entry : kAovTable) {
    if (text == "all")
      chosen.set(static_cast<std::size_t>(entry.aov), !entry.diagnostic && entry.aov != Aov::beauty);
  }
  if (text == "all") return chosen;
  for (const std::string& name : CLI::detail::split(text, ',')) {
    const std::optional<Aov> aov = find_aov(name);
    if (!aov || info(*aov).diagnostic) {
      std::string known;
      for (const AovInfo& entry : kAovTable) {
        if (!entry.diagnostic && entry.aov != Aov::beauty) known += fmt::format("{}, ", entry.name);
      }
      throw Error(ExitStatus::usage,
                  fmt::format("--aovs: no AOV '{}'{}; expected some of {}all or none", name,
                              aov ? " of the tracer (the filter's come with --diagnostics)" : "", known));
    }
    chosen.set(static_cast<std::size_t>(*aov), *aov != Aov::beauty);
  }
  return chosen;
}

std::string format_aovs(const AovSet& aovs) {
  std::string text;
  for (const AovInfo& entry : kAovTable) {
    if (!aovs.test(static_cast<std::size_t>(entry.aov))) continue;
    text += fmt::format("{}{}", text.empty() ? "" : ",", entry.name);
  }
  return text.empty() ? "none" : text;
}

struct Size {
  int width = 0;
  int height = 0;
};

Size parse_size(const std::string& text) {
  Size size;
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const bool crossed = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = crossed ? std::from_chars(width.ptr + 1, end, size.height) : width;
  const auto fits = [](int side) { return side >= 1 && side <= kLargestSide; };
  if (!crossed || height.ec != std::errc() || height.ptr != end || !fits(size.width) || !fits(size.height)) {
    throw Error(
        ExitStatus::usage,
        fmt::format("--size {}: expected WIDTHxHEIGHT, such as 640x360, each 1 to {}", text, kLargestSide));
  }
  return size;
}

/// One run of `becalm render`.
class RenderJob {
 public:
  explicit RenderJob(const RenderCommand& command);
  ExitStatus run();

 private:
  void find_existing();
  std::optional<Frame> make_noisy(int frame);
  std::optional<Frame> trace(int frame);
  void write_noisy(const Frame& frame);
  void denoise_and_write(Frame& noisy);

  io::Attributes render_attributes(const AovSet& aovs, bool float_colors) const;

  const RenderCommand& command_;
  const ThreadLimit threads_;
  const AovSet asked_;
  std::optional<FilterStep> filter_;
  const AovSet rendered_;  ///< what was asked for and what the filter wants
  tracer::Scene scene_;
  const std::string scene_hash_;
  Size size_;
  std::optional<Outputs> outputs_;
  std::optional<Outputs> noisy_outputs_;
  io::Attributes attributes_;
  io::Attributes noisy_attributes_;
  std::set<int> existing_;
  std::set<int> existing_noisy_;
  std::optional<Progress> progress_;
  Profile profile_;
};

RenderJob::RenderJob(const RenderCommand& command)
    : command_(command),
      threads_(command.output.threads),
      asked_(parse_aovs(command.aovs)),
      filter_(command.preset.empty() ? std::nullopt
                                     : std::make_optional<FilterStep>(command.preset, command.filter)),
      rendered_(asked_ | (filter_ ? filter_->wanted() : AovSet())),
      scene_(tracer::load_scene(command.scene)),
      scene_hash_(scene_hash(command.scene)) {
  const tracer::SceneDescription& scene = scene_.description();
  size_ = command.size.empty() ? Size{scene.film.width, scene.film.height} : parse_size(command.size);
  std::vector<int> frames;
  if (command.output.frames.empty()) {
    frames.resize(static_cast<std::size_t>(scene.frames.last - scene.frames.first + 1));
    std::iota(frames.begin(), frames.end(), scene.frames.first);
  } else {
    frames = io::parse_frame_range(command.output.frames);
  }
  outputs_.emplace("-o", command.output.pattern, frames);
  attributes_ = render_attributes(asked_, command.float_colors);
  if (filter_) {
    attributes_.back().second += ' ' + filter_->describe(frames.front());
    attributes_.emplace_back("becalm:preset", command.preset);
  }
  if (!command.keep_noisy.empty()) {
    noisy_outputs_.emplace("--keep-noisy", command.keep_noisy, frames);
    std::vector<std::string> written;
    for (const int frame : frames) written.push_back(outputs_->path(frame));
    noisy_outputs_->keep_apart_from(written);
    noisy_attributes_ = render_attributes(rendered_, /*float_colors=*/true);
  }
}

io::Attributes RenderJob::render_attributes(const AovSet& aovs, bool float_colors) const {
  return {{"becalm:version", BECALM_VERSION},
          {"becalm:settings", fmt::format("scene={} size={}x{} spp={} seed={} aovs={} color={}", scene_hash_,
                                          size_.width, size_.height, command_.spp, command_.seed,
                                          format_aovs(aovs), float_colors ? "float" : "half")}};
}

void RenderJob::find_existing() {
  const auto find = [](const Outputs& outputs, const io::Attributes& attributes) {
    Outputs::Existing found = outputs.find_existing(attributes);
    warn_unusable(found.unusable);
    return std::move(found.frames);
  };
  existing_ = find(*outputs_, attributes_);
  if (noisy_outputs_) existing_noisy_ = find(*noisy_outputs_, noisy_attributes_);
}

ExitStatus RenderJob::run() {
  outputs_->prepare();
  if (noisy_outputs_) noisy_outputs_->prepare();
  if (command_.output.resume) find_existing();
  const std::vector<int>& asked = outputs_->frames();

  std::vector<int> work = up_to_last_missing(asked, existing_);
  if (!filter_) std::erase_if(work, [&](int frame) { return existing_.contains(frame); });
  if (work.empty()) return all_there(asked.size(), command_.output.quiet);

  if (filter_) filter_->build(size_.width, size_.height, rendered_);
  progress_.emplace(
      ProgressOptions{.total = asked.size(),
                      .existing = existing_.size(),
                      .work = work.size(),
                      .unit = "samples",
                      .units_per_frame = static_cast<double>(size_.width) * size_.height * command_.spp,
                      .quiet = command_.output.quiet});
  catch_signals();
  {
    // The tracer makes frame n+1 while this works on frame n.
    Stage<Frame> behind_tracer(
        1, [this](Frame& frame) { denoise_and_write(frame); }, request_stop);
    for (const int number : work) {
      std::optional<Frame> frame = make_noisy(number);
      if (!frame || stop_requested()) break;
      behind_tracer.push(std::move(*frame));
    }
    behind_tracer.finish(/*drop=*/interrupted());
  }
  if (filter_) filter_->finish(profile_);
  return conclude(*progress_, asked.size(), command_.output.profile ? &profile_ : nullptr);
}

std::optional<Frame> RenderJob::make_noisy(int frame) {
  if (existing_noisy_.contains(frame)) {
    const ProfileScope scope(profile_, "read");
    return io::read_exr(noisy_outputs_->path(frame), frame, rendered_).frame;
  }
  std::optional<Frame> noisy = trace(frame);
  if (noisy && noisy_outputs_) write_noisy(*noisy);
  return noisy;
}

std::optional<Frame> RenderJob::trace(int frame) {
  tracer::RenderOptions options;
  options.width = size_.width;
  options.height = size_.height;
  options.spp = command_.spp;
  options.seed = command_.seed;
  options.aovs = rendered_;
  options.progress = [this, frame](double share) { progress_->update(frame, share); };
  options.cancel = &stop_requested();
  tracer::RenderReport report;
  const ProfileScope scope(profile_, "render");
  std::optional<Frame> noisy = tracer::render_frame(scene_, frame, options, &report);
  if (report.non_finite_samples > 0) {
    progress_->warn(fmt::format("frame {}: {} samples were NaN or Inf and were left out", frame,
                                report.non_finite_samples));
  }
  return noisy;
}

void RenderJob::write_noisy(const Frame& frame) {
  const ProfileScope scope(profile_, "write noisy");
  io::write_exr(noisy_outputs_->path(frame.number()), frame, noisy_attributes_, io::PixelType::float32);
}

void RenderJob::denoise_and_write(Frame& noisy) {
  Frame result(noisy.number(), noisy.width(), noisy.height());
  if (filter_) {
    filter::Denoised denoised = filter_->denoise(noisy, *progress_, profile_);
    result = std::move(denoised.frame);
  } else {
    result.image(Aov::beauty) = std::move(noisy.image(Aov::beauty));
  }
  if (existing_.contains(noisy.number())) {
    progress_->frame_kept(noisy.number());
    return;
  }
  // What was asked for comes from the tracer as it is, as `becalm denoise` passes it on from a file.
  for (const AovInfo& entry : kAovTable) {
    if (entry.diagnostic || entry.aov == Aov::beauty) continue;
    result.image(entry.aov) =
        asked_.test(static_cast<std::size_t>(entry.aov)) ? std::move(noisy.image(entry.aov)) : Image();
  }
  io::WriteReport report;
  {
    const ProfileScope scope(profile_, "write");
    report = io::write_exr(outputs_->path(result.number()), result, attributes_,
                           command_.float_colors ? io::PixelType::float32 : io::PixelType::half);
  }
  warn_overflows(*progress_, result.number(), report, "--float keeps them");
  progress_->frame_written(result.number());
}

void check_filter_options_unused(const RenderCommand& command) {
  if (!command.preset.empty()) return;
  const char* unused = !command.keep_noisy.empty()           ? "--keep-noisy"
                       : !command.filter.assignments.empty() ? "--set"
                       : command.filter.diagnostics          ? "--diagnostics"
                       : !command.filter.device.empty()      ? "--device"
                       : command.filter.validate             ? "--validate"
                                                             : nullptr;
  if (unused != nullptr) {
    throw Error(ExitStatus::usage, fmt::format("{} says how to denoise, and there is no --denoise", unused));
  }
}

}  // namespace

Command add_render(CLI::App& becalm) {
  CLI::App& parser = *becalm.add_subcommand("render", "Render a scene to EXR files, denoised or not");
  auto command = std::make_shared<RenderCommand>();
  parser.add_option("scene", command->scene, "The scene, a JSON file")->required()->type_name("SCENE.json");
  add_output_options(parser, command->output, "the scene's");
  parser
      .add_option(
          "--aovs", command->aovs,
          "Layers besides the beauty: albedo, normal, depth, motion, variance, half_a, half_b joined by "
          "commas, all or none (default: none)")
      ->type_name("LIST")
      ->group("Output");
  parser.add_flag("--float,!--half-float", command->float_colors, "Colours as 32-bit float (default: half)")
      ->group("Output");
  parser.add_option("--spp", command->spp, "Samples per pixel (default: 8)")
      ->check(CLI::Range(1, 65536))
      ->type_name("N")
      ->group("Rendering");
  parser.add_option("--size", command->size, "Image size in pixels (default: the scene's)")
      ->type_name("WxH")
      ->group("Rendering");
  parser.add_option("--seed", command->seed, "Another seed is another, independent noise (default: 0)")
      ->type_name("N")
      ->group("Rendering");
  parser
      .add_flag("--denoise{balanced}", command->preset,
                "Denoise while rendering; --denoise=draft, =balanced (default) or =final")
      ->group("Filter");
  parser
      .add_option(
          "--keep-noisy", command->keep_noisy,
          "With --denoise, also write the noisy frames, as float with all that the filter reads; --resume "
          "reads them instead of rendering again")
      ->type_name("PATTERN")
      ->group("Filter");
  add_filter_options(parser, command->filter);
  parser.footer(
      "Examples:\n"
      "  becalm render room.json -o 'out/room.####.exr' --frames 1-24 --spp 8 --aovs all\n"
      "  becalm render room.json -o 'out/room.####.exr' --spp 4 --denoise=final --resume\n"
      "What --set takes is listed by becalm denoise --help.\n");
  return {&parser, [command] {
            check_filter_options_unused(*command);
            return RenderJob(*command).run();
          }};
}

}  // namespace becalm::app
