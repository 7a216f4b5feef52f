#include "frame/io/samples.h"

#include <gtest/gtest.h>
#include <half.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace becalm::io {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// What to_samples makes of the values.
template <class T>
std::vector<T> samples_of(Imf::PixelType type, const std::vector<float>& values, std::size_t overflows = 0) {
  std::vector<T> samples(values.size());
  EXPECT_EQ(to_samples(type, values, reinterpret_cast<char*>(samples.data())), overflows);
  return samples;
}

template <class T>
std::vector<float> values_of(Imf::PixelType type, const std::vector<T>& samples) {
  std::vector<float> values(samples.size());
  from_samples(type, reinterpret_cast<const char*>(samples.data()), values);
  return values;
}

TEST(Samples, OfEveryHalfAreItsValue) {
  std::vector<std::uint16_t> halves(1u << 16);
  std::iota(halves.begin(), halves.end(), std::uint16_t{0});
  const std::vector<float> values = values_of(Imf::HALF, halves);
  const std::vector<std::uint16_t> back = samples_of<std::uint16_t>(Imf::HALF, values);
  for (const std::uint16_t bits : halves) {
    const float expected = imath_half_to_float(bits);
    if (std::isnan(expected)) {
      ASSERT_TRUE(std::isnan(values[bits])) << bits;
      ASSERT_TRUE(std::isnan(imath_half_to_float(back[bits]))) << bits;
    } else {
      ASSERT_EQ(values[bits], expected) << bits;
      ASSERT_EQ(back[bits], bits);
    }
  }
}

// Runs of all lengths up to two vectors of 8, so that every value meets a vector and the rest behind it.
TEST(Samples, AreRoundedAsImathDoes) {
  const std::vector<float> some{
      1.0f + 0x1p-11f, 1.0f + 0x1.8p-10f, -0x1p-25f, 0x1.8p-25f, 0x1p-130f, -0.0f, 0.1f,
      65504.0f,        -3.7e-6f,          1234.567f, -65503.9f,  kInfinity};
  for (std::size_t length = 1; length <= 17; ++length) {
    for (std::size_t first = 0; first < some.size(); ++first) {
      std::vector<float> values;
      for (std::size_t i = 0; i < length; ++i) values.push_back(some[(first + i) % some.size()]);
      const std::vector<std::uint16_t> halves = samples_of<std::uint16_t>(Imf::HALF, values);
      for (std::size_t i = 0; i < length; ++i) {
        ASSERT_EQ(halves[i], imath_float_to_half(values[i])) << values[i] << " at " << i << " of " << length;
      }
    }
  }
}

// Each value in a vector, and in the rest.
TEST(Samples, BeyondHalvesAreTheirLargestAndCounted) {
  const auto expect = [](float value, float expected, std::size_t overflows) {
    const std::vector<float> values(9, value);
    const std::vector<std::uint16_t> halves = samples_of<std::uint16_t>(Imf::HALF, values, 9 * overflows);
    for (const float back : values_of(Imf::HALF, halves)) EXPECT_EQ(back, expected) << value;
  };
  for (const float sign : {1.0f, -1.0f}) {
    for (const float beyond : {65504.5f, 65519.0f, 65536.0f, 3e38f})
      expect(sign * beyond, sign * 65504.0f, 1);
    expect(sign * 65504.0f, sign * 65504.0f, 0);
    expect(sign * kInfinity, sign * kInfinity, 0);
  }
}

TEST(Samples, OfFloatsKeepTheirBits) {
  const std::vector<std::uint32_t> bits{0x3f8ccccd, 0x80000000, 0x7f800000, 0x000002ca, 0x7fc12345};
  std::vector<float> values(bits.size());
  from_samples(Imf::FLOAT, reinterpret_cast<const char*>(bits.data()), values);
  for (std::size_t i = 0; i < bits.size(); ++i) EXPECT_EQ(std::bit_cast<std::uint32_t>(values[i]), bits[i]);
  EXPECT_EQ(samples_of<std::uint32_t>(Imf::FLOAT, values), bits);
}

TEST(Samples, OfWholeNumbersAreRoundedWithinTheirRange) {
  const std::vector<float> values{2.5f, 7.4f, -3.0f, NAN, 5e9f};
  EXPECT_EQ(samples_of<std::uint32_t>(Imf::UINT, values),
            (std::vector<std::uint32_t>{3, 7, 0, 0, std::numeric_limits<std::uint32_t>::max()}));
  EXPECT_EQ(values_of(Imf::UINT, std::vector<std::uint32_t>{0, 3, 1u << 31}),
            (std::vector<float>{0.0f, 3.0f, 0x1p31f}));
}

}  // namespace
}  // namespace becalm::io
