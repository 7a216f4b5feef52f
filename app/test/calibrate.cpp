#include "app/test/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "app/test/case_run.h"
#include "frame/error.h"

namespace becalm::app {
namespace {

void require_measured(const TestCase& test, bool is_measured, const std::string& judge,
                      const std::string& key) {
  if (is_measured) return;
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: {} {}: cannot be measured in these frames", test.full_name(), judge, key));
}

/// The worst frame's value of one run. Throws Error(bad_input) if no frame has one.
double worst_of(const TestCase& test, const FigureLimit& limit, const Measurements& measured) {
  const std::vector<FrameFigures>& frames =
      limit.judge == "denoised" ? measured.denoised_frames : measured.frames;
  const Figure& figure = *limit.figure;
  const FrameFigures* worst = find_beyond(figure, limit.limit, frames).worst;
  require_measured(test, worst != nullptr, limit.judge, limit.key);
  return worst->*figure.value;
}

/// The nearest number of 12 decimal digits: 0.87 instead of 0.8699999999999999.
double without_rounding(double limit) {
  return std::stod(fmt::format("{:.12g}", limit));
}

/// Rounded away from the values, to three digits.
double rounded_up(double limit) {
  if (!(limit > 0.0)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(limit)) - 2.0);
  return without_rounding(std::ceil(limit / unit) * unit);
}

/// The value that one more draw of a normal distribution exceeds with probability `rate`.
double normal_limit(const std::vector<double>& values, double rate) {
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const boost::math::students_t distribution(n - 1.0);
  const double quantile = boost::math::quantile(boost::math::complement(distribution, rate));
  return mean + quantile * std::sqrt(squares / (n - 1.0) * (1.0 + 1.0 / n));
}

/// The same of errors: their logarithms count as normal, or with two references, whose errors may be
/// negative, they themselves.
double upper_limit(std::vector<double> values, double rate) {
  if (!std::ranges::all_of(values, [](double value) { return value > 0.0; }))
    return normal_limit(values, rate);
  for (double& value : values) value = std::log(value);
  return std::exp(normal_limit(values, rate));
}

/// Within what the figure can be.
double propose(const FigureLimit& limit, std::vector<double> values, double rate) {
  switch (limit.figure->limit) {
    case LimitKind::max:
      return std::min(rounded_up(upper_limit(values, rate)), limit.figure->most);
    case LimitKind::min:  // SSIM, whose distance from 1 is an error
      for (double& value : values) value = 1.0 - value;
      return std::max(0.0, without_rounding(1.0 - rounded_up(upper_limit(values, rate))));
    case LimitKind::max_absolute:
      break;
  }
  const double high = normal_limit(values, 0.5 * rate);
  for (double& value : values) value = -value;
  return rounded_up(std::max(high, normal_limit(values, 0.5 * rate)));
}

/// One limit's values over the seeds.
struct Series {
  std::string judge;
  std::string key;
  std::vector<double> values;
  double now;       ///< the suite's limit
  double proposed;  ///< from the values
};

std::string line_of(const Series& series) {
  const auto [least, most] = std::ranges::minmax_element(series.values);
  return fmt::format("  {} {}: {:.4g} to {:.4g}; limit {:g} in the suite, {:g} proposed", series.judge,
                     series.key, *least, *most, series.now, series.proposed);
}

class Calibration {
 public:
  Calibration(const TestCase& test, int seeds) : test_(test), seeds_(seeds) {}

  void add(const CaseRun& run) {
    runs_.push_back(run.measured);
    for (const CheckResult& check : run.result.checks) {
      if (check.judge != "statistical") continue;
      failed_ += check.passed ? 0 : 1;
      largest_share_ = std::max(largest_share_, check.value / check.limit);
    }
  }

  std::vector<std::string> lines() const {
    std::vector<Series> all = series();
    std::vector<std::string> lines{fmt::format("{}: {} seeds, false-alarm rate {:g}", test_.full_name(),
                                               seeds_, test_.false_alarm_rate)};
    if (test_.judges.statistical) {
      lines.push_back(
          fmt::format("  statistical: {} of {} frames failed; the largest score is {:.2f} of its threshold",
                      failed_, seeds_ * test_.source.frames.size(), largest_share_));
    }
    nlohmann::ordered_json proposal;
    for (const Series& series : all) {
      lines.push_back(line_of(series));
      proposal[series.judge][series.key] = series.proposed;
    }
    if (!all.empty()) lines.push_back(fmt::format("  \"judged_by\": {}", proposal.dump()));
    return lines;
  }

 private:
  std::vector<Series> series() const {
    std::vector<FigureLimit> limits = test_.judges.limits;
    if (test_.judges.denoised) {
      limits.insert(limits.end(), test_.judges.denoised->limits.begin(), test_.judges.denoised->limits.end());
    }
    const SequenceJudge sequence = test_.judges.sequence.value_or(SequenceJudge{});
    const double count = static_cast<double>(limits.size()) + (sequence.max_temporal_error ? 1.0 : 0.0) +
                         (sequence.max_flicker ? 1.0 : 0.0);
    const double rate = -std::expm1(std::log1p(-test_.false_alarm_rate) / count);
    std::vector<Series> all;
    for (const FigureLimit& limit : limits) {
      Series series{limit.judge, limit.key, {}, limit.limit, 0.0};
      for (const Measurements& run : runs_) series.values.push_back(worst_of(test_, limit, run));
      series.proposed = propose(limit, series.values, rate);
      all.push_back(std::move(series));
    }
    const auto add_sequence = [&](const char* key, std::optional<double> now, double Measurements::*value) {
      if (!now) return;
      Series series{"sequence", key, {}, *now, 0.0};
      for (const Measurements& run : runs_) {
        require_measured(test_, !std::isnan(run.*value), series.judge, key);
        series.values.push_back(run.*value);
      }
      series.proposed = rounded_up(upper_limit(series.values, rate));
      all.push_back(std::move(series));
    };
    add_sequence("max_temporal_error", sequence.max_temporal_error, &Measurements::temporal_error);
    add_sequence("max_flicker", sequence.max_flicker, &Measurements::flicker);
    return all;
  }

  const TestCase& test_;
  const int seeds_;
  std::vector<Measurements> runs_;
  std::size_t failed_ = 0;
  double largest_share_ = 0.0;
};

}  // namespace

std::vector<std::string> calibrate(const TestCase& test, int seeds, const WorkFolder& folder, int threads,
                                   bool reproducible) {
  require_seed(test);
  Calibration calibration(test, seeds);
  for (int i = 0; i < seeds; ++i) {
    const RunSettings settings{.work_folder = folder.folder_of(test, fmt::format("seed_{}", i)),
                               .threads = threads,
                               .reproducible = reproducible};
    const CaseRun run = run_case(test, settings, static_cast<std::uint32_t>(i));
    if (run.interrupted) throw Error(ExitStatus::interrupted, "interrupted");
    if (!run.judged) {
      throw Error(ExitStatus::bad_input, fmt::format("{}: seed {}: {}", test.full_name(),
                                                     test.source.seed + i, run.result.messages.front()));
    }
    calibration.add(run);
  }
  return calibration.lines();
}

}  // namespace becalm::app
