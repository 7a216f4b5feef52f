#include "app/test/pixel_judges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/frame_figures.h"
#include "app/test/references.h"
#include "frame/error.h"
#include "frame/io/exr_channels.h"
#include "frame/io/printable.h"
#include "frame/judge/exact.h"
#include "frame/judge/statistical.h"

namespace becalm::app {
namespace {

std::string part_name(const io::ExrChannels::Part& part) {
  return part.name.empty() ? "without a name" : io::printable(part.name);
}

/// NaN against a number is infinitely many.
double ulps_of(const judge::Difference& difference) {
  return difference.ulps ? static_cast<double>(*difference.ulps) : std::numeric_limits<double>::infinity();
}

/// Both references together.
struct Reference {
  Image mean;
  Image variance;
  double samples;
  double rounding;
  double variance_rounding;

  judge::Estimate estimate() const { return {mean, &variance, samples, rounding, variance_rounding}; }
};

Reference both(const JudgedFrame& files, const PlacedFrame& a, const PlacedFrame* b) {
  Reference reference{a.frame.image(Aov::beauty), a.frame.image(Aov::variance),
                      samples_of_reference(files.reference), a.beauty_rounding, a.variance_rounding};
  if (b == nullptr) return reference;
  reference.mean = mean_image(reference.mean, b->frame.image(Aov::beauty));
  reference.variance = mean_image(reference.variance, b->frame.image(Aov::variance));
  for (float& value : reference.variance.data()) value *= 0.5f;
  reference.samples += samples_of_reference(files.reference_b);
  reference.rounding = std::max(a.beauty_rounding, b->beauty_rounding);
  reference.variance_rounding = 0.5 * std::max(a.variance_rounding, b->variance_rounding);
  return reference;
}

/// What a file of halves would hold of radiance beyond its range.
void limit_to_half(Image& image) {
  constexpr float largest = 65504.0f;
  for (float& value : image.data()) value = std::min(value, largest);
}

}  // namespace

CheckResult judge_exactly(const ExactJudge& judge, const JudgedFrame& files) {
  CheckResult check{.judge = "exact",
                    .figure = "ulps",
                    .frame = files.number,
                    .limit = static_cast<double>(judge.max_ulps),
                    .passed = true,
                    .text = fmt::format("frame {} is equal", files.number)};
  const auto fail = [&](double ulps, std::string text) {
    check.passed = false;
    check.value = ulps;
    check.text = fmt::format("frame {}: {}", files.number, text);
    return check;
  };
  constexpr double all = std::numeric_limits<double>::infinity();
  const io::ExrChannels test(files.test);
  const io::ExrChannels reference(files.reference);
  if (test.parts().size() < reference.parts().size()) {
    return fail(all, fmt::format("has {} parts, and its reference has {}", test.parts().size(),
                                 reference.parts().size()));
  }
  for (std::size_t i = 0; i < reference.parts().size(); ++i) {
    const io::ExrChannels::Part& expected = reference.parts()[i];
    const auto found = std::ranges::find(test.parts(), expected.name, &io::ExrChannels::Part::name);
    if (found == test.parts().end()) return fail(all, fmt::format("part {} is missing", part_name(expected)));
    if (found->is_deep || expected.is_deep) {
      return fail(all, fmt::format("part {} is deep, which cannot be compared", part_name(expected)));
    }
    if (found->data_window != expected.data_window || found->display_window != expected.display_window) {
      return fail(all, fmt::format("part {} has other data or display windows", part_name(expected)));
    }
    const auto part = static_cast<std::size_t>(found - test.parts().begin());
    for (const std::string& name : expected.channels) {
      const std::string what = io::printable(expected.name.empty() ? name : expected.name + ": " + name);
      if (std::ranges::find(found->channels, name) == found->channels.end()) {
        return fail(all, what + " is missing");
      }
      const Image fresh = test.read(part, name);
      const Image known = reference.read(i, name);
      if (!fresh.same_shape(known)) return fail(all, what + " has pixels of another kind");
      const bool are_halves = test.stores_half(part, name) && reference.stores_half(i, name);
      const judge::ExactResult result =
          judge::compare_exactly(fresh, known, are_halves ? judge::Stored::half : judge::Stored::float32);
      if (result.passed()) continue;
      const double ulps = ulps_of(*result.largest);
      if (judge.max_ulps == 0 || ulps > check.limit) {
        return fail(ulps, fmt::format("{}: {}", what, judge::describe(result)));
      }
      check.value = std::max(check.value, ulps);
      check.text = fmt::format("frame {} differs by {} ulps at most", files.number, check.value);
    }
  }
  return check;
}

CheckResult judge_statistically(const TestCase& test, const JudgedFrame& files, const PlacedFrame& fresh,
                                const PlacedFrame& reference, const PlacedFrame* reference_b) {
  for (const PlacedFrame* placed : {&reference, reference_b}) {
    if (placed == nullptr || placed->frame.has(Aov::variance)) continue;
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: the reference has no variance; make it again with --update={}",
                            placed == &reference ? files.reference : files.reference_b, test.name));
  }
  Reference expected = both(files, reference, reference_b);
  if (expected.samples < 2.0) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: expected a reference of two samples or more", files.reference));
  }
  const double frames = static_cast<double>(test.source.frames.size());
  // Of files of half; more than what sums of floats are rounded by here and on other machines.
  constexpr double relative_rounding = 0x1p-11;
  const judge::StatisticalOptions options{
      .false_alarm_rate = -std::expm1(std::log1p(-test.false_alarm_rate) / frames),
      .rounding = relative_rounding};
  Image mean = fresh.frame.image(Aov::beauty);
  if (expected.rounding > 0.0) limit_to_half(mean);
  if (fresh.beauty_rounding > 0.0f) limit_to_half(expected.mean);
  const Image& variance = fresh.frame.image(Aov::variance);
  const judge::StatisticalResult result =
      judge::compare_statistically({.mean = mean,
                                    .variance = variance.empty() ? nullptr : &variance,
                                    .samples = static_cast<double>(test.source.spp),
                                    .rounding = fresh.beauty_rounding,
                                    .variance_rounding = fresh.variance_rounding},
                                   expected.estimate(), options);
  return {.judge = "statistical",
          .figure = "z",
          .frame = files.number,
          .value = std::abs(result.worst_level().worst.z),
          .limit = result.worst_level().threshold,
          .passed = result.passed(),
          .text = fmt::format("frame {}: {}", files.number, judge::describe(result))};
}

}  // namespace becalm::app
