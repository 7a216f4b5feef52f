// Feeds bytes as the pixels of a test and a reference to the judges: any floats, NaN and Inf among them.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "frame/judge/exact.h"
#include "frame/judge/statistical.h"

namespace {

using becalm::Image;

void require(bool holds) {
  if (!holds) std::abort();
}

Image take_image(FuzzedDataProvider& bytes, int width, int height, int channels) {
  Image image(width, height, channels);
  for (float& value : image.data()) {
    const auto bits = bytes.ConsumeIntegral<std::uint32_t>();
    std::memcpy(&value, &bits, sizeof value);
  }
  return image;
}

bool is_finite(const Image& image) {
  for (const float value : image.data()) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

void judge_exactly(const Image& test, const Image& reference) {
  const becalm::judge::ExactResult result = becalm::judge::compare_exactly(test, reference);
  require(result.passed() == !result.first.has_value());
  require(!becalm::judge::describe(result).empty());
  require(becalm::judge::compare_exactly(test, test).passed());
  require(becalm::judge::compare_exactly(test, test, becalm::judge::Stored::half).passed());
}

void judge_statistically(const becalm::judge::Estimate& test, const becalm::judge::Estimate& reference) {
  const becalm::judge::StatisticalResult result = becalm::judge::compare_statistically(test, reference);
  if (!is_finite(test.mean) || !is_finite(reference.mean)) require(!result.passed());
  for (const becalm::judge::BlockLevel& level : result.levels) {
    require(level.worst.p_value >= 0.0 && level.worst.p_value <= 1.0);
    require(!std::isnan(level.worst.z));
  }
  require(!becalm::judge::describe(result).empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider bytes(data, size);
  const int width = bytes.ConsumeIntegralInRange(1, 40);
  const int height = bytes.ConsumeIntegralInRange(1, 40);
  const int channels = bytes.ConsumeBool() ? 3 : 1;
  const bool has_variance = bytes.ConsumeBool();
  const double samples = bytes.ConsumeIntegralInRange(1, 64);
  const Image test = take_image(bytes, width, height, channels);
  const Image reference = take_image(bytes, width, height, channels);
  const Image test_variance = take_image(bytes, width, height, channels);
  const Image variance = take_image(bytes, width, height, channels);
  judge_exactly(test, reference);
  judge_statistically({test, has_variance ? &test_variance : nullptr, samples},
                      {reference, &variance, 16.0 * samples});
  return 0;
}
