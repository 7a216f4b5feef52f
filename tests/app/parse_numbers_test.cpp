#include "app/parse_numbers.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace becalm::app {
namespace {

TEST(ParseNumber, TakesASignAndNothingAround) {
  for (const char* text : {"1500", "+1500", "1.5e3"}) EXPECT_EQ(parse_number<double>(text), 1500.0) << text;
  EXPECT_EQ(parse_number<double>("-0.25"), -0.25);
  EXPECT_EQ(parse_number<std::int64_t>("+8"), 8);
  for (const char* text : {"", "+", "+-1", "++1", " 1", "1 ", "1x", "0x10", "1,5", "1e400"})
    EXPECT_EQ(parse_number<double>(text), std::nullopt) << text;
  for (const char* text : {"1e3", "8x", "9223372036854775808"})
    EXPECT_EQ(parse_number<std::int64_t>(text), std::nullopt) << text;
}

TEST(ParseNumbers, TakesAsManyAsAreAsked) {
  std::array<int, 2> sides{};
  EXPECT_TRUE(parse_numbers("640x360", 'x', std::span<int>(sides)));
  EXPECT_EQ(sides, (std::array{640, 360}));
  for (const char* text : {"640", "640x", "640x360x1", "640,360"})
    EXPECT_FALSE(parse_numbers(text, 'x', std::span<int>(sides))) << text;
}

}  // namespace
}  // namespace becalm::app
