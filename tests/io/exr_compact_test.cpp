#include <gtest/gtest.h>

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

TEST(CompactExr, WritesAlphaWhereItIsNot1) {
  const TemporaryFolder folder;
  Frame frame(1, 2, 2);
  frame.add(Aov::beauty, 1.0f).at(1, 1, 3) = 0.25f;
  write_compact_exr(folder.path("alpha.exr"), frame, {});
  EXPECT_EQ(read_exr(folder.path("alpha.exr"), 1, {}).frame.image(Aov::beauty).at(1, 1, 3), 0.25f);
}

}  // namespace
}  // namespace becalm::io
