// bench_judge [RUNS]: how often the statistical judge fails frames of unchanged expectation, and which
// changes it finds, on simulated frames.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/judge/simulated.h"

namespace becalm::judge {
namespace {

/// The least that a reference should have, over the frame's samples.
constexpr int kReferenceFactor = 16;

void print_false_alarms(int runs) {
  fmt::print("Share of {} frames of 16x16 pixels that fail at the stated rate:\n\n", runs);
  fmt::print("| noise | samples | at 1 % | without variance | at 0.1 % | without variance |\n");
  fmt::print("| --- | ---: | ---: | ---: | ---: | ---: |\n");
  for (const Noise noise : kNoises) {
    for (const int samples : {4, 16, 64}) {
      std::string cells;
      for (const double rate : {0.01, 0.001}) {
        const FalseAlarms alarms =
            count_false_alarms(noise, samples, kReferenceFactor * samples, runs, rate, 1);
        const auto percent = [&](int count) { return 100.0 * count / runs; };
        cells += fmt::format(" {:.2f} % | {:.2f} % |", percent(alarms.with_variance),
                             percent(alarms.without_variance));
      }
      fmt::print("| {} | {} |{}\n", name(noise), samples, cells);
    }
  }
}

constexpr int kEdge = 64;
constexpr double kLeast = 1e-4;
constexpr double kMost = 10.0;

/// The least change that each frame shows.
struct Found {
  std::vector<double> with_variance;
  std::vector<double> without_variance;
};

/// The least brightening of the square that fails the frame, to 2 %; infinite where kMost does not.
double least_found(const SimulatedImage& frame, const SimulatedImage& reference, int at, int edge,
                   bool with_variance) {
  const auto fails = [&](double change) {
    SimulatedImage changed = frame;
    brighten(changed, at, at, edge, 1.0 + change);
    return !compare_statistically(with_variance ? changed.estimate() : changed.without_variance(),
                                  reference.estimate())
                .passed();
  };
  if (!fails(kMost)) return HUGE_VAL;
  double low = kLeast;
  double high = kMost;
  while (high > 1.02 * low) {
    const double middle = std::sqrt(low * high);
    (fails(middle) ? high : low) = middle;
  }
  return high;
}

std::string percent_of_nine_in_ten(std::vector<double>& changes) {
  const auto at = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() * 9 / 10);
  std::ranges::nth_element(changes, at);
  return std::isfinite(*at) ? fmt::format("{:.2g} %", 100.0 * *at) : "-";
}

void print_power(int frames) {
  fmt::print("\nBrightening that nine in ten of {} frames of {}x{} pixels show, at the rate of 0.01 %:\n\n",
             frames, kEdge, kEdge);
  fmt::print("| noise | samples | whole image | without variance | 5x5 pixels | without variance |\n");
  fmt::print("| --- | ---: | ---: | ---: | ---: | ---: |\n");
  for (const Noise noise : kNoises) {
    for (const int samples : {4, 16, 64, 256}) {
      SampleSource source(noise, 2);
      const SimulatedImage reference = simulate(source, kEdge, kReferenceFactor * samples);
      Found whole;
      Found object;
      for (int i = 0; i < frames; ++i) {
        const SimulatedImage frame = simulate(source, kEdge, samples);
        whole.with_variance.push_back(least_found(frame, reference, 0, kEdge, true));
        whole.without_variance.push_back(least_found(frame, reference, 0, kEdge, false));
        object.with_variance.push_back(least_found(frame, reference, kEdge / 2, 5, true));
        object.without_variance.push_back(least_found(frame, reference, kEdge / 2, 5, false));
      }
      fmt::print("| {} | {} | {} | {} | {} | {} |\n", name(noise), samples,
                 percent_of_nine_in_ten(whole.with_variance), percent_of_nine_in_ten(whole.without_variance),
                 percent_of_nine_in_ten(object.with_variance),
                 percent_of_nine_in_ten(object.without_variance));
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace becalm::judge

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 10000;
  becalm::judge::print_false_alarms(runs);
  becalm::judge::print_power(std::max(10, runs / 100));
}
