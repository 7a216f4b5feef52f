#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "frame/io/exr.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {
namespace {

TEST(CompactExr, KeepsHalvesAndTheVarianceWithinItsRounding) {
  const TemporaryFolder folder;
  Frame frame(1, 3, 2);
  frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::variance);
  frame.add(Aov::depth, 4.0f);
  float value = 1e-6f;
  for (float& variance : frame.image(Aov::variance).data()) variance = value *= 5.0f;
  frame.image(Aov::beauty).at(2, 1, 0) = 0.333251953125f;  // a number of half
  write_compact_exr(folder.path("compact.exr"), frame, {{"becalm:version", "1"}});
  const Frame read = read_exr(folder.path("compact.exr"), 1, AovSet().set()).frame;
  EXPECT_EQ(read.image(Aov::beauty).at(2, 1, 0), 0.333251953125f);
  EXPECT_EQ(read.image(Aov::beauty).at(2, 1, 3), 1.0f);
  EXPECT_EQ(read.image(Aov::depth).at(0, 0, 0), 4.0f);
  for (std::size_t i = 0; i < frame.image(Aov::variance).data().size(); ++i) {
    const float expected = frame.image(Aov::variance).data()[i];
    EXPECT_NEAR(read.image(Aov::variance).data()[i], expected, 0.27f * expected) << i;
  }
  EXPECT_EQ(read_attribute(folder.path("compact.exr"), "becalm:version"), "1");
}

TEST(CompactExr, KeepsDepthsBeyondHalf) {
  const TemporaryFolder folder;
  Frame frame(1, 2, 1);
  frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::depth, 3e6f);
  frame.image(Aov::depth).at(1, 0, 0) = std::numeric_limits<float>::infinity();
  write_compact_exr(folder.path("compact.exr"), frame, {});
  const Frame read = read_exr(folder.path("compact.exr"), 1, AovSet().set()).frame;
  EXPECT_EQ(read.image(Aov::depth).at(0, 0, 0), 3e6f);
  EXPECT_EQ(read.image(Aov::depth).at(1, 0, 0), std::numeric_limits<float>::infinity());
}

/// Types of R and noiselevel.R as they are written, and both channels read again.
struct Written {
  std::vector<std::string> types;
  Image beauty;
  Image variance;
};

Written written(float value, float deviation) {
  const TemporaryFolder folder;
  Frame frame(1, 8, 8);
  frame.add(Aov::beauty, 1.0f);
  for (int c = 0; c < 3; ++c) frame.image(Aov::beauty).at(3, 4, c) = value;
  frame.add(Aov::variance, deviation * deviation);
  write_compact_exr(folder.path("compact.exr"), frame, {});
  Written file;
  const ExrDescription described = describe_exr(folder.path("compact.exr"));
  for (const ExrDescription::Channel& channel : described.parts.at(0).channels) {
    if (channel.name == "R" || channel.name == "noiselevel.R") file.types.push_back(channel.type);
  }
  const LoadedFrame read = read_exr(folder.path("compact.exr"), 1, AovSet().set());
  file.beauty = read.frame.image(Aov::beauty);
  file.variance = read.frame.image(Aov::variance);
  return file;
}

TEST(CompactExr, WritesFloatsWhereHalfWouldLoseMoreThanNoise) {
  using Types = std::vector<std::string>;
  EXPECT_EQ(written(0.3f, 1e-3f).types, (Types{"half", "half"}));
  EXPECT_EQ(written(1e-9f, 1e-3f).types, (Types{"half", "half"})) << "noise hides the rounding";
  EXPECT_EQ(written(1e-9f, 1e-8f).types, (Types{"float", "float"}));
  EXPECT_EQ(written(1e5f, 1.0f).types, (Types{"float", "half"}));
  EXPECT_EQ(written(1e5f, 1e5f).types, (Types{"float", "float"}));
  const Written dark = written(1e-9f, 1e-8f);
  EXPECT_EQ(dark.beauty.at(3, 4, 1), 1e-9f);
  EXPECT_NEAR(dark.variance.at(3, 4, 1), 1e-16f, 0.27e-16f);
}

TEST(CompactExr, ReadersKnowTheRoundingOfHalves) {
  const TemporaryFolder folder;
  Frame frame(1, 2, 2);
  frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::variance, 0.25f);
  const auto rounding = [&](const std::string& name, Aov aov) {
    return read_exr(folder.path(name), 1, AovSet().set()).rounding[static_cast<std::size_t>(aov)];
  };
  write_compact_exr(folder.path("compact.exr"), frame, {});
  EXPECT_EQ(rounding("compact.exr", Aov::beauty), 0x1p-25f);
  EXPECT_EQ(rounding("compact.exr", Aov::variance), 0x1p-50f) << "a deviation";
  write_exr(folder.path("half.exr"), frame, {});
  EXPECT_EQ(rounding("half.exr", Aov::beauty), 0x1p-25f);
  EXPECT_EQ(rounding("half.exr", Aov::variance), 0.0f);
  write_exr(folder.path("float.exr"), frame, {}, PixelType::float32);
  EXPECT_EQ(rounding("float.exr", Aov::beauty), 0.0f);
}

TEST(CompactExr, WritesAlphaWhereItIsNot1) {
  const TemporaryFolder folder;
  Frame frame(1, 2, 2);
  frame.add(Aov::beauty, 1.0f).at(1, 1, 3) = 0.25f;
  write_compact_exr(folder.path("alpha.exr"), frame, {});
  EXPECT_EQ(read_exr(folder.path("alpha.exr"), 1, {}).frame.image(Aov::beauty).at(1, 1, 3), 0.25f);
}

}  // namespace
}  // namespace becalm::io
