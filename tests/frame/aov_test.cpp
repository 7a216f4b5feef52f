#include <gtest/gtest.h>

#include "frame/frame.h"

namespace becalm {
namespace {

TEST(AovTable, RowsStandInTheOrderOfTheEnumeration) {
  for (std::size_t i = 0; i < kAovCount; ++i) {
    EXPECT_EQ(static_cast<std::size_t>(kAovTable[i].aov), i);
    EXPECT_FALSE(kAovTable[i].channels.empty());
    EXPECT_FALSE(kAovTable[i].description.empty());
  }
}

TEST(AovTable, EveryNameIsFoundAgain) {
  EXPECT_EQ(find_aov("beauty"), Aov::beauty);
  EXPECT_EQ(find_aov(""), std::nullopt);
  EXPECT_EQ(find_aov("Albedo"), std::nullopt);
  for (const AovInfo& entry : kAovTable) {
    if (entry.aov == Aov::beauty) continue;
    EXPECT_EQ(find_aov(entry.name), entry.aov) << entry.name;
  }
}

TEST(Frame, HoldsTheImagesThatWereAddedAndNoOthers) {
  Frame frame(7, 3, 2);
  EXPECT_EQ(frame.number(), 7);
  EXPECT_TRUE(frame.aovs().none());
  frame.add(Aov::normal, 0.5f).at(2, 1, 2) = 1.0f;
  EXPECT_TRUE(frame.has(Aov::normal));
  EXPECT_EQ(frame.aovs().count(), 1u);
  EXPECT_EQ(frame.image(Aov::normal).channels(), 3);
  EXPECT_EQ(frame.image(Aov::normal).data().back(), 1.0f);
  EXPECT_EQ(frame.image(Aov::normal).data().front(), 0.5f);
  frame.remove(Aov::normal);
  EXPECT_TRUE(frame.aovs().none());
}

}  // namespace
}  // namespace becalm
