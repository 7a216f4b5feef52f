#include <gtest/gtest.h>

#include "tests/judge/simulated.h"

namespace becalm::judge {
namespace {

constexpr int kRuns = 2000;
constexpr double kRate = 0.05;
/// 100 are expected at that rate; in one of 2,000 counts there are this many or more.
constexpr int kMostAlarms = 134;

class FalseAlarmsOf : public testing::TestWithParam<Noise> {};

/// With the least samples that the reference should have. `scripts/bench judge` counts 10,000 runs at
/// three sample counts.
TEST_P(FalseAlarmsOf, AreNoMoreThanStated) {
  for (const int samples : {4, 16}) {
    const FalseAlarms alarms = count_false_alarms(GetParam(), samples, 16 * samples, kRuns, kRate, 1);
    EXPECT_LT(alarms.with_variance, kMostAlarms) << samples << " samples";
    EXPECT_LT(alarms.without_variance, kMostAlarms) << samples << " samples";
    if (GetParam() != Noise::gaussian) continue;
    // A judge that never fails would be of no use: where nothing is skewed, most of the rate is used.
    EXPECT_GT(alarms.with_variance, kRuns * kRate / 4) << samples << " samples";
    EXPECT_GT(alarms.without_variance, kRuns * kRate / 4) << samples << " samples";
  }
}

INSTANTIATE_TEST_SUITE_P(Noises, FalseAlarmsOf, testing::ValuesIn(kNoises),
                         [](const auto& info) { return std::string(name(info.param)); });

/// A worse sampler, whose 32 samples have the noise of 4, is no change of the mean.
TEST(FalseAlarms, OfMoreNoiseEverywhereAreNoMoreThanStated) {
  constexpr int runs = 400;
  constexpr int most = 36;  // 20 are expected; in one of 2,000 counts there are this many or more
  SampleSource source(Noise::lognormal, 2);
  int alarms = 0;
  SimulatedImage reference;
  for (int run = 0; run < runs; ++run) {
    if (run % 20 == 0) reference = simulate(source, 16, 512);
    SimulatedImage frame = simulate(source, 16, 4);
    frame.samples = 32.0;
    const StatisticalResult result =
        compare_statistically(frame.estimate(), reference.estimate(), {.false_alarm_rate = kRate});
    alarms += result.passed() ? 0 : 1;
  }
  EXPECT_LT(alarms, most);
}

}  // namespace
}  // namespace becalm::judge
