// becalm compare: the figures of a sequence against a reference, and a failure where they pass a limit.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "app/cancel.h"
#include "app/command.h"
#include "app/compare_report.h"
#include "app/compared_sequence.h"
#include "app/console.h"
#include "app/counted.h"
#include "app/eye_names.h"
#include "app/folder_input.h"
#include "app/frame_figures.h"
#include "app/input_frames.h"
#include "app/json_number.h"
#include "app/measure_frames.h"
#include "app/options.h"
#include "app/outputs.h"
#include "app/parse_numbers.h"
#include "app/report_file.h"
#include "frame/io/frame_range.h"
#include "frame/io/layers.h"
#include "frame/io/sequence.h"

namespace becalm::app {
namespace {

/// The option that limits a figure; in the order of kFigures.
struct LimitOption {
  const char* name;
  const char* help;
};

constexpr std::array<LimitOption, kFigures.size()> kLimitOptions{{
    {"--max-relmse", "Largest relMSE"},
    {"--min-psnr", "Smallest PSNR, in dB for a peak of 1"},
    {"--min-ssim", "Smallest SSIM"},
    {"--max-flip", "Largest mean FLIP, of 67 pixels per degree, after clamping to [0,1]"},
    {"--max-temporal", "Largest temporal error"},
    {"--max-energy", "Largest share by which the mean may differ: 0.01 is 1 %"},
}};

struct CompareCommand {
  std::string reference;
  std::string test;
  std::string reference_b;
  std::string frames;
  std::string layers;
  std::string view;
  std::string report;
  std::string json;
  bool quiet = false;
  int threads = 0;                                            ///< 0: all processors
  std::array<std::optional<double>, kFigures.size()> limits;  ///< in the order of kFigures
};

std::vector<ReportFile> reports_of(const CompareCommand& command) {
  std::vector<ReportFile> files;
  if (!command.report.empty()) files.push_back(page_in(command.report, ReportKind::compare_page));
  if (!command.json.empty()) files.push_back({"--json", command.json, ReportKind::compare_json});
  return files;
}

/// The figures as lines of text, from the first frame on that could be read. Each is there at once. What
/// cannot be written is told at the end, by `main`: reports are still to come.
class Table {
 public:
  /// `to` null: nowhere.
  explicit Table(std::FILE* to) : to_(to) {}

  void print_row(const std::string& name, const FrameFigures& figures) {
    std::string row = std::exchange(has_header_, true) ? "" : header();
    row += fmt::format("{:>6}", name);
    for (const Figure& figure : kFigures) {
      row += fmt::format("  {:>11}", has_value(figure, figures) ? figure.format(figures.*figure.value) : "-");
    }
    row += '\n';
    if (to_ == nullptr) return;
    std::fputs(row.c_str(), to_);
    std::fflush(to_);
  }

 private:
  static std::string header() {
    std::string text = fmt::format("{:>6}", "frame");
    for (const Figure& figure : kFigures) text += fmt::format("  {:>11}", figure.title);
    return text + '\n';
  }

  std::FILE* to_;
  bool has_header_ = false;
};

nlohmann::ordered_json to_json(const FrameFigures& figures) {
  nlohmann::ordered_json json;
  for (const Figure& figure : kFigures) json[figure.key] = json_number(figures.*figure.value);
  json["skipped_pixels"] = figures.skipped;
  return json;
}

/// One run of `becalm compare`.
class CompareJob {
 public:
  explicit CompareJob(const CompareCommand& command);
  ExitStatus run();

 private:
  std::vector<ComparedSequence*> sequences();
  void require_all_frames();
  ComparedFrame read(int frame);
  std::vector<std::string> find_failures(const std::vector<FrameFigures>& figures) const;
  std::string json_text(const std::vector<FrameFigures>& figures,
                        const std::vector<std::string>& failures) const;

  const CompareCommand& command_;
  const io::LayerOptions layers_;
  ComparedSequence reference_;
  ComparedSequence test_;
  std::optional<ComparedSequence> reference_b_;
  std::vector<int> frames_;
};

/// A number that the figure can be; where it bounds from above, no negative one.
CLI::Validator limit_of(const Figure& figure) {
  return CLI::Validator(
      [&figure](const std::string& text) {
        const std::optional<double> value = parse_number<double>(text);
        const bool has_least = figure.limit != LimitKind::min;
        const bool is_number = value && std::isfinite(*value) && *value <= figure.most;
        if (is_number && (!has_least || *value >= 0.0)) return std::string();
        return fmt::format(
            "expected a finite number{}{}, found {}", has_least ? " of at least 0" : "",
            figure.most < std::numeric_limits<float>::max() ? fmt::format(", at most {:g}", figure.most) : "",
            text);
      },
      "");
}

CompareJob::CompareJob(const CompareCommand& command)
    : command_(command),
      layers_{.layers = io::parse_layer_overrides(command.layers)},
      reference_(command.reference, layers_, command.view),
      test_(command.test, layers_, command.view) {
  for (const std::string& text : {command.reference, command.test, command.reference_b}) {
    refuse_eye_field(text);
    refuse_folder(text);
  }
  if (!command.reference_b.empty()) {
    for (const std::string& given : {command.reference, command.test}) {
      if (resolved(command.reference_b) != resolved(given)) continue;
      throw Error(ExitStatus::usage,
                  fmt::format("--reference-b {}: is given twice, expected a second reference of "
                              "independent noise",
                              command.reference_b));
    }
    reference_b_.emplace(command.reference_b, layers_, command.view);
  }
  const io::SequencePattern& reference = reference_.pattern();
  frames_ = !command.frames.empty()       ? io::parse_frame_range(command.frames)
            : reference.has_frame_field() ? reference.frames_on_disk()
                                          : std::vector<int>{io::number_in_name(command.reference)};
  if (command.frames.empty() && reference.has_frame_field()) reference.refuse_wider_numbers();
  if (frames_.empty()) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: no frame of this sequence is on disk{}",
                                                   command.reference, reference.hint_where_missing()));
  }
  for (const ComparedSequence* sequence : sequences()) {
    if (sequence->pattern().has_frame_field() || frames_.size() == 1) continue;
    throw Error(ExitStatus::usage, fmt::format("{}: {} frames need a frame field, such as ####.exr",
                                               sequence->pattern().text(), frames_.size()));
  }
  require_all_frames();
  for (ComparedSequence* sequence : sequences()) sequence->choose_layer(frames_);
}

/// Before anything is measured: figures of frames before a missing one would be lost.
void CompareJob::require_all_frames() {
  if (frames_.size() == 1) return;  // reading it tells
  for (const ComparedSequence* sequence : sequences()) {
    const io::SequencePattern& pattern = sequence->pattern();
    std::vector<int> missing;
    std::ranges::copy_if(frames_, std::back_inserter(missing), [&](int frame) {
      std::error_code error;
      return !std::filesystem::exists(pattern.path(frame), error) && !error;
    });
    if (missing.empty()) continue;
    std::vector<int> present;
    std::ranges::set_difference(frames_, missing, std::back_inserter(present));
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no file for frame {} of {}{}{}", pattern.path(missing.front()),
                            io::format_frame_range(missing), counted(frames_.size(), "frame", "frames"),
                            pattern.hint_where_missing(),
                            present.empty() ? ""
                                            : "; --frames " + io::format_frame_range(present) +
                                                  " compares those that are there"));
  }
}

std::vector<ComparedSequence*> CompareJob::sequences() {
  std::vector<ComparedSequence*> all{&reference_, &test_};
  if (reference_b_) all.push_back(&*reference_b_);
  return all;
}

ComparedFrame CompareJob::read(int frame) {
  PlacedBeauty reference = reference_.read(frame);
  ComparedFrame images{.frame = frame,
                       .first = reference.first,
                       .display_middle = reference.display_middle,
                       .test = {},
                       .reference = {},
                       .reference_b = {},
                       .reference_mean = {}};
  images.test = test_.read_like(frame, reference);
  if (reference_b_) images.reference_b = reference_b_->read_like(frame, reference);
  images.reference = std::move(reference.beauty);
  if (reference_b_) images.reference_mean = mean_image(images.reference, images.reference_b);
  return images;
}

ExitStatus CompareJob::run() {
  std::optional<CompareReport> report;
  const std::vector<ReportFile> reports = reports_of(command_);
  std::vector<ReportFile> written = reports;
  if (!command_.report.empty()) {
    report.emplace(command_.report);
    std::ranges::move(report->pictures(frames_), std::back_inserter(written));
  }
  check_report_files(written);
  std::vector<FrameFigures> figures;
  Table table(command_.quiet ? nullptr : stream_beside(reports));
  const int step =
      usual_step(reference_.pattern().has_frame_field() ? reference_.pattern().frames_on_disk() : frames_);
  const auto tell = [&](const MeasuredFrame& measured) {
    const FrameFigures& frame = figures.emplace_back(measured.figures);
    table.print_row(std::to_string(frame.frame), frame);
    if (frame.skipped > 0) {
      warn(fmt::format("frame {}: {} pixels are not finite and were left out", frame.frame, frame.skipped));
    }
    if (report) report->add(frame.frame, measured.images.test, measured.images.best_reference());
  };
  measure_frames(
      frames_, step, [this](int frame) { return read(frame); }, tell);
  if (figures.empty()) stop_if_asked();
  table.print_row("mean", mean_of(figures));

  const bool is_whole = figures.size() == frames_.size();
  const std::vector<std::string> failures =
      is_whole ? find_failures(figures)
               : std::vector{fmt::format("interrupted: {} of {} compared", figures.size(),
                                         counted(frames_.size(), "frame", "frames"))};
  for (const std::string& failure : failures) is_whole ? warn(failure) : say_interrupted(failure);
  write_report_files(reports, [&](ReportKind kind) {
    return kind == ReportKind::compare_json
               ? json_text(figures, failures)
               : report->page(fmt::format("{} against {}", command_.test, command_.reference), figures);
  });
  if (!is_whole) return ExitStatus::interrupted;
  return failures.empty() ? ExitStatus::done : ExitStatus::comparison_failed;
}

/// A limit holds for every frame: one bad frame in a hundred is seen, and would not be in the mean. Pixels
/// that are not finite are within no limit.
std::vector<std::string> CompareJob::find_failures(const std::vector<FrameFigures>& figures) const {
  std::vector<std::string> failures;
  const bool has_limits =
      std::ranges::any_of(command_.limits, [](const auto& limit) { return limit.has_value(); });
  for (const FrameFigures& frame : figures) {
    if (!has_limits || frame.skipped == 0) continue;
    failures.push_back(
        fmt::format("failed: {} pixels of frame {} are not finite", frame.skipped, frame.frame));
  }
  for (std::size_t i = 0; i < kFigures.size(); ++i) {
    const Figure& figure = kFigures[i];
    const std::optional<double> limit = command_.limits[i];
    if (!limit) continue;
    const BeyondLimit found = find_beyond(figure, *limit, figures);
    if (found.measured == 0) {
      failures.push_back(
          fmt::format("failed: no {} could be measured for {}: no two frames that follow each other have one "
                      "display window and finite pixels in common",
                      figure.title, kLimitOptions[i].name));
    }
    if (found.failed == 0) continue;
    failures.push_back(fmt::format("failed: {} of frame {} is {}, and {} is {:g} ({} of {} frames)",
                                   figure.title, found.worst->frame,
                                   figure.format(found.worst->*figure.value), kLimitOptions[i].name, *limit,
                                   found.failed, found.measured));
  }
  return failures;
}

std::string CompareJob::json_text(const std::vector<FrameFigures>& figures,
                                  const std::vector<std::string>& failures) const {
  nlohmann::ordered_json json;
  json["reference"] = command_.reference;
  if (reference_b_) json["reference_b"] = command_.reference_b;
  json["test"] = command_.test;
  json["frames"] = nlohmann::ordered_json::array();
  for (const FrameFigures& entry : figures) {
    nlohmann::ordered_json row;
    row["frame"] = entry.frame;
    row.update(to_json(entry));
    json["frames"].push_back(row);
  }
  json["mean"] = to_json(mean_of(figures));
  json["failures"] = failures;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace

Command add_compare(CLI::App& becalm) {
  CLI::App& parser = *becalm.add_subcommand("compare", "Measure a sequence against a reference");
  auto command = std::make_shared<CompareCommand>();
  parser.add_option("reference", command->reference, "The reference: a pattern or one file")
      ->required()
      ->option_text("REFERENCE");
  parser.add_option("test", command->test, "What is measured: a pattern or one file")
      ->required()
      ->option_text("TEST");
  parser
      .add_option(
          "--reference-b", command->reference_b,
          "A second, independent reference: its noise and the first one's no longer count as error; FLIP "
          "takes the mean of both, whose noise does")
      ->option_text("SECOND")
      ->group("Input");
  parser
      .add_option("--frames", command->frames, "Frames to compare (default: those of the reference on disk)")
      ->option_text("RANGE")
      ->group("Input");
  parser
      .add_option("--layers", command->layers,
                  "The layer to compare in every file, if its name is not recognised: beauty=NAME")
      ->option_text("beauty=NAME")
      ->group("Input");
  parser
      .add_option(
          "--view", command->view,
          "The view of stereo files that is compared, such as right (default: the reference's default view)")
      ->option_text("NAME")
      ->group("Input");
  parser
      .add_option("--json", command->json,
                  "Write the figures to this file too: null where one was not measured, \"inf\" where it is "
                  "infinite, as the PSNR of equal images is; - is standard output, and the table then goes "
                  "to standard error")
      ->option_text("FILE")
      ->group("Output");
  parser
      .add_option("--report", command->report,
                  "Write pictures of the errors and an index.html into this folder")
      ->option_text("DIR")
      ->group("Output");
  parser.add_flag("-q,--quiet", command->quiet, "No table; warnings and failures stay")->group("Output");
  add_threads_option(parser, command->threads);
  for (std::size_t i = 0; i < kFigures.size(); ++i) {
    parser.add_option(kLimitOptions[i].name, command->limits[i], kLimitOptions[i].help)
        ->check(limit_of(kFigures[i]))
        ->option_text("X")
        ->group("Limits (any frame beyond one: exit status 1)");
  }
  parser.footer(
      "Examples:\n"
      "  becalm compare 'ref/shot.####.exr' 'out/shot.####.exr' --report report\n"
      "  becalm compare ref.exr out.exr --max-relmse 0.01 --max-energy 0.005\n");
  return {&parser, [command] {
            const ThreadLimit threads(command->threads);
            catch_signals();
            empty_earlier(reports_of(*command));
            return CompareJob(*command).run();
          }};
}

}  // namespace becalm::app
