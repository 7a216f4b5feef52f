// Each check finds what it is for in a small frame, and nothing in a sound one.
#include "frame/audit/audit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace becalm::audit {
namespace {

constexpr int kSize = 64;
constexpr float kNoise = 0.1f;

/// A texture that has moved by 3 px to the right in each frame, under noise of the seed.
Frame frame_of(int number, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0.0f, kNoise);
  Frame frame(number, kSize, kSize);
  for (const Aov aov : {Aov::beauty, Aov::albedo, Aov::normal, Aov::motion, Aov::variance}) frame.add(aov);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float at = static_cast<float>(x - 3 * number);
      const float texture = 0.5f + 0.3f * std::sin(at / 4.0f) * std::cos(static_cast<float>(y) / 3.0f);
      const float slope = std::sin(static_cast<float>(x + y) / 5.0f);
      for (int c = 0; c < 3; ++c) {
        frame.image(Aov::beauty).at(x, y, c) = texture + 0.5f + noise(random);
        frame.image(Aov::albedo).at(x, y, c) = texture;
        frame.image(Aov::variance).at(x, y, c) = kNoise * kNoise;
      }
      frame.image(Aov::beauty).at(x, y, 3) = 1.0f;
      frame.image(Aov::normal).at(x, y, 0) = std::sqrt(1.0f - slope * slope);
      frame.image(Aov::normal).at(x, y, 2) = slope;
      frame.image(Aov::motion).at(x, y, 0) = -3.0f;
    }
  }
  return frame;
}

std::string found(const Frame& frame, const Frame* before = nullptr) {
  std::string names;
  for (const Finding& finding : audit({frame, before})) {
    names += (names.empty() ? "" : " ") + finding.check;
    EXPECT_NE(finding.text.find_first_of("0123456789"), std::string::npos) << "no figure: " << finding.text;
  }
  return names;
}

TEST(Audit, ASoundFrameHasNoFinding) {
  const Frame before = frame_of(1, 1);
  const Frame frame = frame_of(2, 2);
  EXPECT_EQ(found(frame, &before), "");
  EXPECT_EQ(found(frame), "");
}

/// Boxes of other albedo before a wall, under noise.
Frame frame_of_boxes() {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(1.0f, 0.5f);
  std::uniform_int_distribution<int> position(0, 150);
  Frame frame(1, 160, 120);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  Image& albedo = frame.add(Aov::albedo, 0.2f);
  for (int box = 0; box < 12; ++box) {
    const int left = position(random);
    const int top = position(random) % 120;
    for (int y = top; y < std::min(top + 25, 120); ++y) {
      for (int x = left; x < std::min(left + 30, 160); ++x) {
        for (int c = 0; c < 3; ++c) albedo.at(x, y, c) = 0.3f + 0.05f * static_cast<float>(box);
      }
    }
  }
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const float light = std::max(noise(random), 0.0f);
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = light * albedo.at(x, y, c);
    }
  }
  return frame;
}

TEST(Audit, FindsAnAlbedoThatIsUpsideDownOrMirrored) {
  const Frame sound = frame_of_boxes();
  EXPECT_EQ(found(sound), "");
  for (const auto& [x_too, y_too] : {std::pair(false, true), std::pair(true, false), std::pair(true, true)}) {
    Frame frame = sound;
    const Image albedo = sound.image(Aov::albedo);
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        for (int c = 0; c < 3; ++c) {
          frame.image(Aov::albedo).at(x, y, c) = albedo.at(x_too ? 159 - x : x, y_too ? 119 - y : y, c);
        }
      }
    }
    EXPECT_EQ(found(frame), "albedo_flipped") << x_too << y_too;
  }
}

TEST(Audit, NothingIsSaidOfBlackFrames) {
  for (const int size : {1, 48}) {
    Frame frame(1, size, size);
    frame.add(Aov::beauty);
    EXPECT_EQ(found(frame), "");
    EXPECT_EQ(found(frame, &frame), "") << "as after a fade";
  }
}

TEST(Audit, FramesThatRepeat) {
  const Frame before = frame_of(1, 1);
  EXPECT_EQ(found(before, &before).find("duplicate"), 0u);
  EXPECT_EQ(found(frame_of(2, 1), &before), "fixed_noise");
}

TEST(Audit, LampsThatStandStillAreNoNoise) {
  Frame before = frame_of(1, 1);
  Frame frame = frame_of(2, 2);
  for (Frame* lit : {&before, &frame}) {
    for (int x = 5; x < 40; x += 7) std::ranges::fill(lit->image(Aov::beauty).pixel(x, 9).first(3), 1e4f);
  }
  EXPECT_EQ(found(frame, &before).find("fixed_noise"), std::string::npos) << found(frame, &before);
}

TEST(Audit, NoiseOfHugeRadianceIsNotThatOfTheFrameBefore) {
  Frame before = frame_of(1, 1);
  Frame frame = frame_of(2, 2);
  for (Frame* huge : {&before, &frame}) {
    huge->remove(Aov::variance);
    for (float& value : huge->image(Aov::beauty).data()) value *= 1e38f;
  }
  EXPECT_EQ(found(frame, &before).find("fixed_noise"), std::string::npos);
}

TEST(Audit, PicturesThatAreNoLongerTheRenderers) {
  Frame clean = frame_of(1, 1);
  Frame clamped = frame_of(1, 1);
  Frame overflowing = frame_of(1, 1);
  Frame spots = frame_of(1, 1);
  for (std::size_t i = 0; i < clean.image(Aov::beauty).pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      clean.image(Aov::beauty).data()[4 * i + c] =
          1.0f + 0.2f * std::sin(static_cast<float>(i % kSize) / 9.0f);
      if (i % 97 == 5) clamped.image(Aov::beauty).data()[4 * i + c] = 10.0f;
      if (i % 797 == 70) spots.image(Aov::beauty).data()[4 * i + c] = 400.0f + static_cast<float>(i);
    }
  }
  overflowing.image(Aov::beauty).data()[400] = 65504.0f;
  overflowing.image(Aov::beauty).data()[800] = INFINITY;
  EXPECT_EQ(found(clean), "denoised");
  EXPECT_EQ(found(clamped), "clamped");
  EXPECT_NE(found(overflowing).find("overflow"), std::string::npos);
  EXPECT_EQ(found(spots), "fireflies");
}

TEST(Audit, ValuesThatAreNotANumber) {
  for (const Aov aov : {Aov::beauty, Aov::albedo, Aov::normal}) {
    Frame frame = frame_of(1, 1);
    frame.image(aov).data()[401] = NAN;
    EXPECT_EQ(found(frame), "not_a_number");
  }
}

TEST(Audit, HalvesOfOneSeed) {
  Frame frame = frame_of(1, 1);
  frame.remove(Aov::variance);
  for (const Aov half : {Aov::half_a, Aov::half_b}) {
    Image& radiance = frame.add(half);
    for (std::size_t i = 0; i < radiance.data().size(); ++i)
      radiance.data()[i] = frame.image(Aov::beauty).data()[i / 3 * 4 + i % 3];
  }
  EXPECT_EQ(found(frame), "same_halves");
  frame.image(Aov::half_a).data()[300] += 0.1f;
  EXPECT_EQ(found(frame), "");
}

TEST(Audit, ColourWithoutAlpha) {
  Frame frame = frame_of(1, 1);
  for (std::size_t i = 0; i < 500; ++i) frame.image(Aov::beauty).data()[4 * i + 3] = 0.0f;
  EXPECT_EQ(found(frame), "premultiplied");
}

TEST(Audit, GuidesThatMislead) {
  Frame bright = frame_of(1, 1);
  for (float& value : bright.image(Aov::albedo).data()) value *= 2.0f;
  EXPECT_EQ(found(bright), "albedo");
  Frame shown = frame_of(1, 1);
  for (float& value : shown.image(Aov::normal).data()) value = 0.5f + 0.5f * value;
  EXPECT_NE(found(shown).find("normal_length"), std::string::npos);
  Frame viewed = frame_of(1, 1);
  for (std::size_t i = 2; i < viewed.image(Aov::normal).data().size(); i += 3) {
    float& z = viewed.image(Aov::normal).data()[i];
    z = std::abs(z) + 1e-3f;
  }
  EXPECT_EQ(found(viewed), "normal_space");
}

TEST(Audit, MotionOfAnotherConvention) {
  const Frame before = frame_of(1, 1);
  const auto text_with = [&](float x, float y) {
    Frame frame = frame_of(2, 2);
    for (std::size_t i = 0; i < frame.image(Aov::motion).pixel_count(); ++i) {
      frame.image(Aov::motion).data()[2 * i] = x;
      frame.image(Aov::motion).data()[2 * i + 1] = y;
    }
    const std::optional<Finding> finding = check_motion({frame, &before});
    return finding ? finding->text : "";
  };
  EXPECT_EQ(text_with(-3.0f, 0.0f), "");
  EXPECT_NE(text_with(3.0f, 0.0f).find("--motion flip-x"), std::string::npos);
  EXPECT_NE(text_with(-6.0f, 0.0f).find("--motion scale=0.5"), std::string::npos);
  EXPECT_NE(text_with(0.0f, -3.0f).find("--motion swap"), std::string::npos);
}

TEST(Audit, AVarianceThatNobodyWrote) {
  Frame frame = frame_of(1, 2);
  frame.image(Aov::variance) = Image(frame.width(), frame.height(), frame.image(Aov::variance).channels());
  EXPECT_TRUE(check_variance({frame}));
  frame.image(Aov::variance).at(3, 3, 1) = kNoise;
  EXPECT_FALSE(check_variance({frame}));
  frame.image(Aov::variance).at(3, 3, 1) = 0.0f;
  std::ranges::fill(frame.image(Aov::beauty).data(), 0.0f);
  EXPECT_FALSE(check_variance({frame})) << "black frames have no noise";
}

TEST(Audit, VarianceThatTheFramesContradict) {
  for (const float factor : {0.1f, 10.0f}) {
    Frame frame = frame_of(1, 2);
    Frame before = frame_of(1, 1);
    for (Frame* one : {&frame, &before}) {
      for (float& value : one->image(Aov::variance).data()) value *= factor;
    }
    EXPECT_TRUE(check_variance({frame, &before})) << factor;
    EXPECT_FALSE(check_variance({frame})) << "nothing to compare it with";
    std::mt19937 random(5);
    std::normal_distribution<float> noise(0.0f, kNoise);
    for (const Aov half : {Aov::half_a, Aov::half_b}) frame.add(half);
    for (std::size_t i = 0; i < frame.image(Aov::half_a).data().size(); ++i) {
      const float difference = noise(random);
      frame.image(Aov::half_a).data()[i] = 1.0f + difference;
      frame.image(Aov::half_b).data()[i] = 1.0f - difference;
    }
    EXPECT_TRUE(check_variance({frame})) << factor;
    for (float& value : frame.image(Aov::variance).data()) value /= factor;
    EXPECT_FALSE(check_variance({frame}));
  }
}

}  // namespace
}  // namespace becalm::audit
