// Cuts are found between shots, and not where only noise, motion or light changes the image.
#include "filter/sequence/cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "filter/input/host_images.h"
#include "tests/filter/pattern.h"

namespace becalm::filter {
namespace {

/// A textured plane, moved by `shift_px` and lit by `light`, with exponential noise as from 1 sample.
Frame make_frame(double shift_px, unsigned scene, double light = 1.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::exponential_distribution<float> noise;
  Frame frame(1, 240, 136);
  frame.add(Aov::beauty, 1.0f);
  frame.add(Aov::albedo);
  frame.add(Aov::normal);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      const auto albedo = static_cast<float>(0.1 + 0.8 * pattern(x + shift_px, y, scene));
      const double angle = 6.0 * pattern(0.5 * (x + shift_px), 0.5 * y, scene + 50);
      for (int c = 0; c < 3; ++c) {
        frame.image(Aov::albedo).at(x, y, c) = albedo;
        frame.image(Aov::beauty).at(x, y, c) = static_cast<float>(light) * albedo * noise(random);
      }
      frame.image(Aov::normal).at(x, y, 0) = static_cast<float>(std::cos(angle));
      frame.image(Aov::normal).at(x, y, 1) = static_cast<float>(std::sin(angle));
    }
  }
  return frame;
}

bool cut_between(const Frame& a, const Frame& b, const AovSet& used = AovSet().set()) {
  const ShotSignature of_a = shot_signature(a, used, exposure(a.image(Aov::beauty)));
  const ShotSignature of_b = shot_signature(b, used, exposure(b.image(Aov::beauty)));
  EXPECT_EQ(is_cut(of_a, of_b), is_cut(of_b, of_a));
  return is_cut(of_a, of_b);
}

TEST(Cuts, NoiseAndMotionAreNone) {
  EXPECT_FALSE(cut_between(make_frame(0, 3), make_frame(0, 3, 1.0, 2)));
  EXPECT_FALSE(cut_between(make_frame(0, 3), make_frame(18, 3, 1.0, 2)));
  EXPECT_FALSE(cut_between(make_frame(0, 3), make_frame(0, 3, 1.0, 2), {})) << "by luminance";
}

TEST(Cuts, FlashesAreNone) {
  EXPECT_FALSE(cut_between(make_frame(0, 3), make_frame(0, 3, 30.0, 2)));
  EXPECT_FALSE(cut_between(make_frame(0, 3), make_frame(0, 3, 30.0, 2), {})) << "by luminance";
  Frame half_lit = make_frame(0, 3, 1.0, 2);
  for (int y = 0; y < half_lit.height(); ++y) {
    for (int x = 0; x < half_lit.width() / 2; ++x) {
      for (int c = 0; c < 3; ++c) half_lit.image(Aov::beauty).at(x, y, c) *= 20.0f;
    }
  }
  EXPECT_FALSE(cut_between(make_frame(0, 3), half_lit));
}

TEST(Cuts, AnotherSceneIsOne) {
  for (const unsigned scene : {4u, 5u, 11u}) {
    EXPECT_TRUE(cut_between(make_frame(0, 3), make_frame(0, scene, 1.0, 2))) << scene;
  }
}

/// As files are read whose data window leaves out the left half and some rows.
Frame cropped(Frame frame) {
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      if (x >= frame.width() / 2 && y >= 20) continue;
      std::ranges::fill(frame.image(Aov::beauty).pixel(x, y), std::nanf(""));
      std::ranges::fill(frame.image(Aov::albedo).pixel(x, y), 1.0f);
      std::ranges::fill(frame.image(Aov::normal).pixel(x, y), 0.0f);
    }
  }
  return frame;
}

TEST(Cuts, OtherDataWindowsAreNone) {
  for (const AovSet& used : {AovSet().set(), AovSet()})
    EXPECT_FALSE(cut_between(make_frame(0, 3), cropped(make_frame(6, 3, 1.0, 2)), used));
  EXPECT_TRUE(cut_between(make_frame(0, 3), cropped(make_frame(0, 4, 1.0, 2))));
}

TEST(Cuts, FramesOfWhichNothingIsKnownShowNoShot) {
  Frame unknown = make_frame(0, 3);
  std::ranges::fill(unknown.image(Aov::beauty).data(), std::nanf(""));
  EXPECT_FALSE(cut_between(make_frame(0, 3), unknown));
  EXPECT_FALSE(has_known_cells(shot_signature(unknown, {}, 1.0f)));
  EXPECT_TRUE(has_known_cells(shot_signature(make_frame(0, 3), {}, 1.0f)));
}

TEST(Cuts, OneCellOfASmallDataWindowIsNone) {
  Frame frame(1, 384, 216);
  frame.add(Aov::beauty, std::nanf(""));
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) std::ranges::fill(frame.image(Aov::beauty).pixel(x, y), 0.5f);
  }
  Frame flash = frame;
  for (int y = 16; y < 32; ++y) {
    for (int x = 16; x < 32; ++x) std::ranges::fill(flash.image(Aov::beauty).pixel(x, y), 6.0f);
  }
  EXPECT_FALSE(cut_between(frame, flash, {}));
}

TEST(Cuts, NormalsOfAnyLengthAreNone) {
  Frame long_ones = make_frame(0, 3), moved = make_frame(3, 3, 1.0, 2);
  for (Frame* frame : {&long_ones, &moved}) {
    for (float& value : frame->image(Aov::normal).data()) value *= 300.0f;
  }
  EXPECT_FALSE(cut_between(long_ones, moved));
}

TEST(Cuts, WhatAppearsCountsAsWhatVanishes) {
  // A quarter of the cells is new; what was there before is still seen beside each of them.
  Frame plain(1, 192, 192);
  plain.add(Aov::beauty, 1.0f);
  plain.add(Aov::albedo, 0.2f);
  Frame with_more = plain;
  for (int y = 0; y < 192; ++y) {
    for (int x = 0; x < 192; ++x) {
      if (x / 8 % 2 == 0 && y / 8 % 2 == 0) std::ranges::fill(with_more.image(Aov::albedo).pixel(x, y), 0.8f);
    }
  }
  EXPECT_TRUE(cut_between(plain, with_more));
  EXPECT_TRUE(cut_between(with_more, plain));
}

TEST(Cuts, WithoutGuidesTheLuminanceShowsThem) {
  Frame dark_above = make_frame(0, 3, 1.0, 2);
  for (int y = 0; y < dark_above.height(); ++y) {
    for (int x = 0; x < dark_above.width(); ++x) {
      for (int c = 0; c < 3; ++c) dark_above.image(Aov::beauty).at(x, y, c) *= y < 60 ? 0.05f : 3.0f;
    }
  }
  EXPECT_TRUE(cut_between(make_frame(0, 3), dark_above, {}));
}

TEST(Cuts, RadianceBeyondFloatsIsBright) {
  Frame black(1, 32, 32);
  black.add(Aov::beauty);
  Frame blown = black;
  std::ranges::fill(blown.image(Aov::beauty).data(), INFINITY);
  EXPECT_TRUE(cut_between(black, blown));
  Frame lit = black;
  std::ranges::fill(lit.image(Aov::beauty).data(), 1e30f);
  EXPECT_FALSE(is_cut(shot_signature(lit, {}, 1.0f), shot_signature(blown, {}, 1.0f)));
}

TEST(Cuts, PixelsThatAreNotFiniteAndTinyImagesAreTaken) {
  Frame bad = make_frame(0, 3, 1.0, 2);
  for (int x = 0; x < 240; ++x) bad.image(Aov::beauty).at(x, 7, 1) = x % 2 == 0 ? NAN : INFINITY;
  for (int x = 0; x < 240; ++x) bad.image(Aov::normal).at(x, 9, 1) = NAN;
  EXPECT_FALSE(cut_between(make_frame(0, 3), bad));
  Frame pixel(1, 1, 1);
  pixel.add(Aov::beauty, 0.5f);
  EXPECT_FALSE(cut_between(pixel, pixel));
}

}  // namespace
}  // namespace becalm::filter
