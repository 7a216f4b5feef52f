#include "app/test/judge_frames.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "app/test/layer_as_beauty.h"
#include "app/test/pixel_judges.h"
#include "frame/error.h"
#include "frame/flicker.h"
#include "frame/io/exr.h"

namespace becalm::app {
namespace {

/// What is wrong with the frames under test, whatever the judges.
struct FrameProblem : std::runtime_error {
  using std::runtime_error::runtime_error;
};

PlacedFrame read_reference(const std::string& path, int number) {
  PlacedFrame reference = read_layer_as_beauty(path, number, "");
  for (const float value : reference.frame.image(Aov::beauty).data()) {
    if (!std::isfinite(value)) {
      throw Error(ExitStatus::bad_input, path + ": the reference has pixels that are not finite");
    }
  }
  return reference;
}

void require_finite(const Image& image, int number) {
  std::size_t count = 0;
  std::string first;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < image.channels(); ++c) {
        const float value = image.at(x, y, c);
        if (std::isfinite(value)) continue;
        if (count++ == 0) first = fmt::format("{} in channel {} of pixel ({}, {})", value, "RGBA"[c], x, y);
        break;
      }
    }
  }
  if (count == 0) return;
  throw FrameProblem(
      fmt::format("frame {}: {} pixels are not finite, the first is {}", number, count, first));
}

PlacedFrame read_test(const std::string& path, int number, const std::string& layer,
                      const PlacedFrame& reference) {
  try {
    PlacedFrame placed = read_layer_as_beauty(path, number, layer);
    const Frame& frame = placed.frame;
    if (frame.width() != reference.frame.width() || frame.height() != reference.frame.height()) {
      throw FrameProblem(fmt::format("frame {} is {}x{}, and its reference {}x{}", number, frame.width(),
                                     frame.height(), reference.frame.width(), reference.frame.height()));
    }
    if (placed.first != reference.first) {
      throw FrameProblem(fmt::format("frame {} begins at pixel ({}, {}), and its reference at ({}, {})",
                                     number, placed.first.x, placed.first.y, reference.first.x,
                                     reference.first.y));
    }
    require_finite(frame.image(Aov::beauty), number);
    return placed;
  } catch (const Error& error) {
    throw FrameProblem(error.what());
  }
}

/// One line with the figure, its value and the limit.
std::string text_of(const std::string& what, const std::string& value, const std::string& key, double limit) {
  return fmt::format("{} is {}, and {} is {:g}", what, value, key, limit);
}

/// Of all frames, as one check.
CheckResult check_limit(const FigureLimit& limit, std::span<const FrameFigures> frames) {
  const Figure& figure = *limit.figure;
  const BeyondLimit beyond = find_beyond(figure, limit.limit, frames);
  CheckResult check{
      .judge = limit.judge, .figure = figure.title, .frame = {}, .limit = limit.limit, .text = {}};
  if (beyond.worst == nullptr) {
    check.text = fmt::format("no {} could be measured for {}", figure.title, limit.key);
    return check;
  }
  check.frame = beyond.worst->frame;
  check.value = beyond.worst->*figure.value;
  check.passed = beyond.failed == 0;
  check.text = text_of(fmt::format("{}{} of frame {}", limit.judge == "denoised" ? "denoised " : "",
                                   figure.title, *check.frame),
                       figure.format(check.value), limit.key, limit.limit);
  if (beyond.failed > 0) check.text += fmt::format(" ({} of {} frames)", beyond.failed, beyond.measured);
  return check;
}

CheckResult check_sequence(const char* figure, const char* key, double value, double limit) {
  return {
      .judge = "sequence",
      .figure = figure,
      .frame = {},
      .value = value,
      .limit = limit,
      .passed = !is_beyond(LimitKind::max, value, limit),
      .text = text_of(fmt::format("{} of the sequence", figure), fmt::format("{:.4e}", value), key, limit)};
}

double mean_temporal_error(std::span<const FrameFigures> frames) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const FrameFigures& frame : frames) {
    if (std::isnan(frame.temporal)) continue;
    sum += frame.temporal;
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

ComparedFrame compared(int number, const Frame& test, const PlacedFrame& reference,
                       const Frame* reference_b) {
  ComparedFrame frame{.frame = number,
                      .first = reference.first,
                      .test = test.image(Aov::beauty),
                      .reference = reference.frame.image(Aov::beauty),
                      .reference_b = {},
                      .reference_mean = {}};
  if (reference_b != nullptr) {
    frame.reference_b = reference_b->image(Aov::beauty);
    frame.reference_mean = mean_image(frame.reference, frame.reference_b);
  }
  return frame;
}

/// Goes through the frames of a case once.
class CaseJudge {
 public:
  CaseJudge(const TestCase& test, Verdict& verdict) : test_(test), verdict_(verdict) {}

  void add(const JudgedFrame& files) {
    const PlacedFrame reference = read_reference(files.reference, files.number);
    std::optional<PlacedFrame> reference_b;
    if (!files.reference_b.empty()) {
      reference_b = read_reference(files.reference_b, files.number);
      if (reference_b->frame.width() != reference.frame.width() ||
          reference_b->frame.height() != reference.frame.height()) {
        throw Error(ExitStatus::bad_input,
                    fmt::format("{}: is not of the size of {}", files.reference_b, files.reference));
      }
    }
    const PlacedFrame fresh = read_test(files.test, files.number, test_.layer, reference);
    if (test_.judges.exact) {
      verdict_.checks.push_back(judge_exactly(*test_.judges.exact, files));
    }
    if (test_.judges.statistical) {
      verdict_.checks.push_back(
          judge_statistically(test_, files, fresh, reference, reference_b ? &*reference_b : nullptr));
    }
    ComparedFrame now =
        compared(files.number, fresh.frame, reference, reference_b ? &reference_b->frame : nullptr);
    verdict_.measured.frames.push_back(measure(now, before_ ? &*before_ : nullptr));
    has_one_place_ = has_one_place_ && (!before_ || now.is_where(*before_));
    if (has_one_place_) flicker_.add(now.test, now.reference, reference_b ? now.reference_b : now.reference);
    before_ = std::move(now);
    if (test_.judges.denoised) add_denoised(files);
  }

  void finish() {
    Measurements& measured = verdict_.measured;
    measured.temporal_error = mean_temporal_error(measured.frames);
    measured.flicker = has_one_place_ ? flicker_.measured().value : std::numeric_limits<double>::quiet_NaN();
    std::vector<CheckResult>& checks = verdict_.checks;
    for (const FigureLimit& limit : test_.judges.limits)
      checks.push_back(check_limit(limit, measured.frames));
    if (test_.judges.denoised) {
      for (const FigureLimit& limit : test_.judges.denoised->limits) {
        checks.push_back(check_limit(limit, measured.denoised_frames));
      }
    }
    if (!test_.judges.sequence) return;
    const SequenceJudge& sequence = *test_.judges.sequence;
    if (sequence.max_temporal_error) {
      checks.push_back(check_sequence("temporal error", "max_temporal_error", measured.temporal_error,
                                      *sequence.max_temporal_error));
    }
    if (sequence.max_flicker) {
      checks.push_back(check_sequence("flicker", "max_flicker", measured.flicker, *sequence.max_flicker));
    }
  }

 private:
  void add_denoised(const JudgedFrame& files) {
    const PlacedFrame reference = read_reference(files.denoised_reference, files.number);
    const Frame fresh = read_test(files.denoised_test, files.number, "", reference).frame;
    ComparedFrame now = compared(files.number, fresh, reference, nullptr);
    verdict_.measured.denoised_frames.push_back(
        measure(now, denoised_before_ ? &*denoised_before_ : nullptr));
    denoised_before_ = std::move(now);
  }

  const TestCase& test_;
  Verdict& verdict_;
  std::optional<ComparedFrame> before_;
  std::optional<ComparedFrame> denoised_before_;
  Flicker flicker_;
  bool has_one_place_ = true;  ///< all frames show the same pixels; else nothing is said of flicker
};

}  // namespace

Verdict judge_frames(const TestCase& test, const std::vector<JudgedFrame>& frames) {
  Verdict verdict;
  CaseJudge judge(test, verdict);
  for (const JudgedFrame& files : frames) {
    try {
      judge.add(files);
    } catch (const FrameProblem& problem) {
      verdict.problems.push_back(problem.what());
      verdict.unjudged.insert(files.number);
    }
  }
  if (verdict.problems.empty()) judge.finish();
  return verdict;
}

}  // namespace becalm::app
