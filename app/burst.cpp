// becalm burst: raw files of one handheld burst, merged before demosaicing into one picture or mosaic.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/burst_frames.h"
#include "app/cancel.h"
#include "app/command.h"
#include "app/console.h"
#include "app/counted.h"
#include "app/help.h"
#include "app/options.h"
#include "app/outputs.h"
#include "app/partial_files.h"
#include "app/profile.h"
#include "app/progress.h"
#include "filter/burst/burst_merger.h"
#include "filter/burst/noise_fit.h"
#include "filter/sequence/frame_filter.h"
#include "frame/error.h"
#include "frame/io/exr.h"
#include "frame/mebibytes.h"
#include "frame/raw/dng.h"

namespace becalm::app {
namespace {

namespace fs = std::filesystem;

/// Sensors end a little below the white level that files tell, and not all pixels at the same value.
constexpr float kSaturated = 0.98f;

constexpr FileMark kMark{.command = "burst", .attribute = "becalm:burst"};

struct BurstCommand {
  std::vector<std::string> inputs;
  std::string output;
  std::string reference = "sharpest";
  std::string noise;
  bool mosaic = false;
  bool overwrite = false;
  FilterOptions filter;
  RunningOptions running;
};

std::string extension(const std::string& path) {
  std::string text = fs::path(path).extension().string();
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// The settings of the aligner that mean something here.
filter::Settings aligner_settings(const std::vector<std::string>& assignments) {
  filter::Settings settings = filter::burst_aligner_settings();
  constexpr std::array<std::string_view, 4> keys{"pyramid", "blur_radius", "distance", "refine_levels"};
  for (const std::string& assignment : assignments) {
    const std::string key = assignment.substr(0, assignment.find('='));
    if (std::ranges::find(keys, key) == keys.end())
      throw Error(ExitStatus::usage,
                  fmt::format("--set {}: expected one of {}", assignment, fmt::join(keys, ", ")));
    filter::set(settings, assignment);
  }
  return settings;
}

std::optional<NoiseModel> given_noise(const std::string& text) {
  if (text.empty()) return std::nullopt;
  NoiseModel noise;
  const char* end = text.data() + text.size();
  const auto a = std::from_chars(text.data(), end, noise.a);
  const bool has_comma = a.ec == std::errc() && a.ptr != end && *a.ptr == ',';
  const auto b = has_comma ? std::from_chars(a.ptr + 1, end, noise.b) : a;
  const bool in_range = noise.a >= 0.0 && noise.b >= 0.0 && noise.a < 1.0 && noise.b < 1.0;
  if (has_comma && b.ec == std::errc() && b.ptr == end && in_range && noise.a + noise.b > 0.0) return noise;
  throw Error(ExitStatus::usage,
              fmt::format("--noise {}: expected A,B, two numbers from 0 to 1 that are not both 0, such as "
                          "1e-3,1e-6",
                          text));
}

class BurstJob {
 public:
  explicit BurstJob(const BurstCommand& command)
      : command_(command),
        aligner_(aligner_settings(command.filter.assignments)),
        given_noise_(given_noise(command.noise)),
        kind_(output_kind()),
        memory_limit_(command.filter) {
    check_reference_text();
  }

  ExitStatus run() {
    frames_.emplace(command_.inputs);
    check_output();
    remove_abandoned_partials({command_.output});
    progress_.emplace(ProgressOptions{.total = frames_->count(),
                                      .work = frames_->count(),
                                      .quiet = command_.running.quiet,
                                      .verbose = command_.running.verbose});
    if (!choose_reference()) return stopped();
    const raw::Info& info = frames_->info(reference_);
    tell_inputs(info);

    std::optional<gpu::Device> device(std::in_place, device_options(command_.filter));
    std::optional<filter::BurstMerger> merger(std::in_place, *device, aligner_, info.cfa, info.width,
                                              info.height, memory_limit_.bytes_of(*device));
    const filter::FilterMemory memory = merger->memory();
    profile_.set_device(device->info().name, memory);
    progress_->detail(fmt::format("device {}, {}, {:.0f} MiB, blocks of {} px", device->info().name,
                                  memory.tile_plan, mebibytes(memory.device.total()), merger->block()));
    merger->start({.samples = mosaic_.samples, .noise = noise_, .saturated = kSaturated}, info.white_balance);
    std::size_t done = 1;
    for (std::size_t frame = 0; frame < frames_->count(); ++frame) {
      if (frame == reference_) continue;
      if (stop_requested()) return stopped();
      progress_->update(static_cast<int>(frame) + 1, static_cast<double>(done));
      merge(*merger, frame);
      progress_->note(fmt::format("{}: merged, {} of {}", frames_->path(frame), ++done, frames_->count()));
    }
    if (stop_requested()) return stopped();
    mosaic_.samples = merger->merged();
    const double mean = merger->mean_weight();
    merger.reset();  // what follows needs the memory
    device.reset();
    write(mean);
    progress_->finish(/*done=*/false);
    if (!command_.running.quiet)
      say(fmt::format("{} written: {} merged, expected noise {:.2f} of a single frame's", command_.output,
                      counted(frames_->count(), "frame", "frames"), 1.0 / std::sqrt(mean)));
    if (!command_.running.quiet && message_format() == MessageFormat::json) {
      say_event({{"event", "end"}, {"written", 1}, {"done", 1}, {"total", 1}});
    }
    if (command_.running.profile) profile_.print();
    return ExitStatus::done;
  }

 private:
  enum class Kind { picture, mosaic_exr, dng };

  Kind output_kind() const {
    const std::string type = extension(command_.output);
    if (type == ".exr") return command_.mosaic ? Kind::mosaic_exr : Kind::picture;
    const bool is_dng = type == ".dng" || type == ".tif" || type == ".tiff";
    if (is_dng && command_.mosaic) {
      throw Error(ExitStatus::usage, fmt::format("--mosaic is for .exr: -o {} is a DNG file, which holds the "
                                                 "mosaic anyway",
                                                 command_.output));
    }
    if (is_dng) return Kind::dng;
    throw Error(ExitStatus::usage,
                fmt::format("-o {}: expected a name that ends in .exr, .dng or .tif", command_.output));
  }

  void check_reference_text() {
    if (command_.reference == "sharpest" || command_.reference == "first") return;
    const char* end = command_.reference.data() + command_.reference.size();
    const auto parsed = std::from_chars(command_.reference.data(), end, given_reference_);
    if (parsed.ec == std::errc() && parsed.ptr == end && given_reference_ >= 1 &&
        given_reference_ <= command_.inputs.size())
      return;
    throw Error(ExitStatus::usage,
                fmt::format("--reference {}: expected sharpest, first or a number from 1 to {}",
                            command_.reference, command_.inputs.size()));
  }

  void check_output() const {
    check_place("-o", command_.output, command_.output);
    std::error_code error;
    if (!fs::exists(command_.output, error)) return;
    if (fs::is_directory(command_.output, error))
      throw Error(ExitStatus::usage, fmt::format("-o {}: is a folder, expected a file", command_.output));
    for (std::size_t i = 0; i < frames_->count(); ++i) {
      if (fs::equivalent(command_.output, frames_->path(i), error))
        throw Error(ExitStatus::usage, fmt::format("-o {}: would overwrite an input", command_.output));
    }
    if (command_.overwrite || !is_foreign(command_.output, kMark)) return;
    throw Error(ExitStatus::usage,
                fmt::format("-o {}: is there already, and {}; --overwrite replaces it", command_.output,
                            kind_ == Kind::dng ? "a DNG does not tell who made it"
                                               : "becalm burst did not write it"));
  }

  /// Reads the reference, and its noise. False if the run is to stop.
  bool choose_reference() {
    if (command_.reference != "sharpest") {
      reference_ = command_.reference == "first" ? 0 : given_reference_ - 1;
      mosaic_ = read(reference_);
      noise_ = noise_of(reference_, mosaic_);
      return true;
    }
    // Frames of one ISO have one noise; were it fitted to each, errors of the fits would rank them.
    std::map<double, std::vector<filter::NoiseBlock>> blocks;
    std::vector<filter::Contrast> contrasts;
    for (std::size_t frame = 0; frame < frames_->count(); ++frame) {
      if (stop_requested()) return false;
      progress_->update(static_cast<int>(frame) + 1, 0.0);
      const Mosaic mosaic = read(frame);
      contrasts.push_back(filter::contrast_of(mosaic));
      const ProfileScope scope(profile_, "fit noise");
      if (!told_noise(frame))
        std::ranges::move(filter::noise_blocks(mosaic, kSaturated),
                          std::back_inserter(blocks[frames_->info(frame).iso]));
    }
    std::map<double, NoiseModel> fitted;
    for (auto& [iso, of_iso] : blocks) fitted[iso] = filter::fit_noise(std::move(of_iso));
    double best = 0.0;
    for (std::size_t frame = 0; frame < frames_->count(); ++frame) {
      const std::optional<NoiseModel> told = told_noise(frame);
      const double scale = 1.0 / frames_->exposure(frame, 0);
      const double sharp =
          scale * scale *
          filter::sharpness(contrasts[frame], told ? *told : fitted[frames_->info(frame).iso],
                            told ? filter::kToldError : filter::kFitError);
      progress_->detail(fmt::format("{}: sharpness {:.3g}", frames_->path(frame), sharp));
      if (frame > 0 && sharp <= best) continue;
      best = sharp;
      reference_ = frame;
    }
    mosaic_ = read(reference_);
    noise_ = noise_of(reference_, mosaic_);
    return true;
  }

  Mosaic read(std::size_t frame) {
    const ProfileScope scope(profile_, "read");
    return frames_->read(frame);
  }

  std::optional<NoiseModel> told_noise(std::size_t frame) const {
    return given_noise_ ? given_noise_ : frames_->info(frame).noise;
  }

  /// In the frame's own exposure.
  NoiseModel noise_of(std::size_t frame, const Mosaic& mosaic) {
    if (const std::optional<NoiseModel> told = told_noise(frame)) return *told;
    const ProfileScope scope(profile_, "fit noise");
    const NoiseModel noise = filter::fit_noise(mosaic, kSaturated);
    if (noise.a + noise.b > 0.0) return noise;
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no noise to be found in it; --noise A,B tells", frames_->path(frame)));
  }

  void tell_inputs(const raw::Info& info) {
    const char* source = given_noise_ ? "as given" : info.noise ? "as the file tells" : "fitted";
    progress_->note(fmt::format("{}: {} {}, {}x{} px, {}, {}", counted(frames_->count(), "frame", "frames"),
                                info.make, info.model, info.width, info.height, describe(info.cfa),
                                describe_exposure(info)));
    progress_->note(fmt::format("reference {}; noise {:.3e},{:.3e} ({})", frames_->path(reference_), noise_.a,
                                noise_.b, source));
  }

  void merge(filter::BurstMerger& merger, std::size_t frame) {
    Mosaic mosaic = read(frame);
    const double exposure = frames_->exposure(frame, reference_);
    // Frames of one ISO have one noise.
    const bool same = frames_->info(frame).iso == frames_->info(reference_).iso;
    NoiseModel noise = same ? noise_
                            : filter::with_least_read_noise(noise_of(frame, mosaic), noise_,
                                                            frames_->iso_ratio(frame, reference_));
    if (exposure != 1.0) {
      progress_->note(fmt::format("{}: {}, scaled to the reference's {}", frames_->path(frame),
                                  describe_exposure(frames_->info(frame)),
                                  describe_exposure(frames_->info(reference_))));
      for (float& value : mosaic.samples.data()) value = static_cast<float>(value / exposure);
      noise.a /= exposure;
      noise.b /= exposure * exposure;
    }
    const ProfileScope scope(profile_, "merge");
    filter::FrameReport report;
    merger.add(
        {.samples = mosaic.samples, .noise = noise, .saturated = static_cast<float>(kSaturated / exposure)},
        report);
    profile_.add(report.passes);
  }

  void write(double mean_weight) {
    const raw::Info& info = frames_->info(reference_);
    io::Attributes attributes{
        {kCommandAttribute, std::string(kMark.command)},
        {"becalm:version", BECALM_VERSION},
        {"becalm:settings", filter::to_string(aligner_)},
        {"becalm:burst",
         fmt::format("frames={} reference={} weight={:.3f}", frames_->count(), reference_ + 1, mean_weight)},
        {"becalm:noise", fmt::format("{:.6e},{:.6e}", noise_.a, noise_.b)},
        {"becalm:camera", info.make + " " + info.model},
        {"becalm:exposure", describe_exposure(info)},
        {"becalm:white_balance", fmt::format("{:.6g}", fmt::join(info.white_balance, ","))}};
    if (kind_ == Kind::picture) {
      Image rgb;
      {
        const ProfileScope scope(profile_, "demosaic");
        rgb = raw::develop(mosaic_, info);
      }
      const ProfileScope scope(profile_, "write");
      Frame frame(1, rgb.width(), rgb.height());
      Image& beauty = frame.add(Aov::beauty, 1.0f);
      for (std::size_t i = 0; i < rgb.pixel_count(); ++i)
        std::copy_n(&rgb.data()[3 * i], 3, &beauty.data()[beauty.channels() * i]);
      io::write_exr(command_.output, frame, attributes, io::PixelType::float32);
      return;
    }
    const ProfileScope scope(profile_, "write");
    if (kind_ == Kind::dng) {
      raw::Info merged = info;
      merged.noise.reset();  // it differs from pixel to pixel
      raw::write_dng(command_.output, mosaic_, merged);
      return;
    }
    attributes.emplace_back("becalm:mosaic", describe(info.cfa));
    attributes.emplace_back("becalm:flip", std::to_string(info.flip));
    attributes.emplace_back("becalm:camera_to_rec709",
                            fmt::format("{:.6g}", fmt::join(info.camera_to_rec709, ",")));
    io::write_plane_exr(command_.output, mosaic_.samples, attributes);
  }

  ExitStatus stopped() {
    progress_->finish(/*done=*/false);
    say_interrupted(fmt::format("interrupted: {} was not written", command_.output));
    return ExitStatus::interrupted;
  }

  const BurstCommand& command_;
  const filter::Settings aligner_;
  const std::optional<NoiseModel> given_noise_;
  const Kind kind_;
  MemoryLimit memory_limit_;
  std::size_t given_reference_ = 0;  ///< from 1
  std::optional<BurstFrames> frames_;
  std::optional<Progress> progress_;
  Profile profile_;
  std::size_t reference_ = 0;
  NoiseModel noise_;
  Mosaic mosaic_;  ///< the reference, then the merged one
};

void add_burst_options(CLI::App& parser, BurstCommand& command) {
  parser.add_option("RAW", command.inputs, "The frames: DNG or a camera's raw files, two or more")
      ->required()
      ->take_all()
      ->option_text("RAW...");
  parser
      .add_option("-o,--output", command.output,
                  ".exr: demosaiced, linear Rec. 709, white balance as shot; .dng or .tif: the merged mosaic "
                  "as a 16-bit DNG file")
      ->required()
      ->option_text("FILE")
      ->group("Output");
  parser
      .add_flag("--mosaic", command.mosaic,
                "With .exr, write the merged mosaic as one channel, black 0 and white 1")
      ->group("Output");
  parser.add_flag("--overwrite", command.overwrite, "Replace a file that this command did not write")
      ->group("Output");
  parser
      .add_option("--reference", command.reference,
                  "The frame that the others are aligned with: sharpest, first or its number from 1 on "
                  "(default: sharpest)")
      ->option_text("sharpest|first|N")
      ->group("Filter");
  parser
      .add_option("--noise", command.noise,
                  "Variance of a sample of value x is A x + B, black 0 and white 1 (default: as DNG's "
                  "NoiseProfile tells, else fitted to the files)")
      ->option_text("A,B")
      ->group("Filter");
  parser
      .add_option(
          "--set", command.filter.assignments,
          "Change one setting of the aligner: pyramid, blur_radius, distance or refine_levels; may be "
          "repeated, and the last of a key holds")
      ->option_text("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false)
      ->group(more("Filter"));
  parser
      .add_option("--device", command.filter.device,
                  "Vulkan device (default: a hardware GPU if there is one)")
      ->option_text("N|NAME")
      ->group(more("Running"));
  parser
      .add_option("--memory", command.filter.memory,
                  "Device memory that may be taken: 512M, 2G, 1.5G (default: what the device has)")
      ->option_text("SIZE")
      ->group("Running");
  parser
      .add_flag("--validate", command.filter.validate,
                "Run under the Vulkan validation layers; any message is an error")
      ->group(more("Running"));
  add_running_options(parser, command.running);
  parser.footer(
      "Frames of one camera and size, held by hand or moving; what moves within them is kept from the\n"
      "reference alone. Frames of other exposures (up to 16 times the first's) are scaled to the "
      "reference's.\n"
      "Examples:\n"
      "  becalm burst IMG_0001.dng IMG_0002.dng IMG_0003.dng -o night.exr\n"
      "  becalm burst burst/*.RAF -o merged.dng --reference first\n");
}

}  // namespace

Command add_burst(CLI::App& becalm) {
  CLI::App& parser = *becalm.add_subcommand("burst", "Merge raw files of a handheld burst into one picture");
  auto command = std::make_shared<BurstCommand>();
  add_burst_options(parser, *command);
  return {&parser, [command] {
            apply(command->running, command->filter);
            const ThreadLimit threads(command->running.threads);
            catch_signals();
            return BurstJob(*command).run();
          }};
}

}  // namespace becalm::app
