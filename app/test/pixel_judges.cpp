#include "app/test/pixel_judges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/frame_figures.h"
#include "app/test/references.h"
#include "frame/error.h"
#include "frame/judge/exact.h"
#include "frame/judge/statistical.h"

namespace becalm::app {
namespace {

std::string layer_name(Aov aov) {
  return aov == Aov::beauty ? "beauty" : std::string(info(aov).name);
}

/// Steps of half where a file of halves was read, of float otherwise; NaN against a number is infinitely
/// many.
double ulps_of(const judge::Difference& difference) {
  if (difference.half_ulps) return static_cast<double>(*difference.half_ulps);
  return difference.ulps ? static_cast<double>(*difference.ulps) : std::numeric_limits<double>::infinity();
}

/// Both references together.
struct Reference {
  Image mean;
  Image variance;
  double samples;
};

Reference both(const JudgedFrame& files, const Frame& a, const Frame* b) {
  Reference reference{a.image(Aov::beauty), a.image(Aov::variance), samples_of_reference(files.reference)};
  if (b == nullptr) return reference;
  reference.mean = mean_image(a.image(Aov::beauty), b->image(Aov::beauty));
  reference.variance = mean_image(a.image(Aov::variance), b->image(Aov::variance));
  for (float& value : reference.variance.data()) value *= 0.5f;
  reference.samples += samples_of_reference(files.reference_b);
  return reference;
}

}  // namespace

CheckResult judge_exactly(const ExactJudge& judge, int number, const Frame& test, const Frame& reference) {
  CheckResult check{.judge = "exact",
                    .figure = "ulps",
                    .frame = number,
                    .limit = static_cast<double>(judge.max_ulps),
                    .passed = true,
                    .text = fmt::format("frame {} is equal", number)};
  for (const AovInfo& entry : kAovTable) {
    const Image& expected = reference.image(entry.aov);
    if (expected.empty()) continue;
    const std::string what = fmt::format("{} of frame {}", layer_name(entry.aov), number);
    if (!test.image(entry.aov).same_shape(expected)) {
      check.passed = false;
      check.value = std::numeric_limits<double>::infinity();
      check.text = what + " is missing";
      return check;
    }
    const judge::ExactResult result = judge::compare_exactly(test.image(entry.aov), expected);
    if (result.passed()) continue;
    check.value = std::max(check.value, ulps_of(*result.largest));
    if (ulps_of(*result.largest) <= check.limit) continue;
    check.passed = false;
    check.text = fmt::format("{}: {}", what, judge::describe(result));
    return check;
  }
  return check;
}

CheckResult judge_statistically(const TestCase& test, const JudgedFrame& files, const Frame& fresh,
                                const Frame& reference, const Frame* reference_b) {
  for (const Frame* frame : {&reference, reference_b}) {
    if (frame == nullptr || frame->has(Aov::variance)) continue;
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: the reference has no variance; make it again with --update={}",
                            frame == &reference ? files.reference : files.reference_b, test.name));
  }
  const Reference expected = both(files, reference, reference_b);
  if (expected.samples < 2.0) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: expected a reference of two samples or more", files.reference));
  }
  const double frames = static_cast<double>(test.source.frames.size());
  constexpr double half_rounding = 0x1p-11;  // references are files of half
  const judge::StatisticalOptions options{
      .false_alarm_rate = -std::expm1(std::log1p(-test.false_alarm_rate) / frames),
      .rounding = half_rounding};
  const Image& variance = fresh.image(Aov::variance);
  const judge::StatisticalResult result = judge::compare_statistically(
      {.mean = fresh.image(Aov::beauty),
       .variance = variance.empty() ? nullptr : &variance,
       .samples = static_cast<double>(test.source.spp)},
      {.mean = expected.mean, .variance = &expected.variance, .samples = expected.samples}, options);
  return {.judge = "statistical",
          .figure = "z",
          .frame = files.number,
          .value = std::abs(result.worst_level().worst.z),
          .limit = result.worst_level().threshold,
          .passed = result.passed(),
          .text = fmt::format("frame {}: {}", files.number, judge::describe(result))};
}

}  // namespace becalm::app
