// Additive AOVs that add up to the beauty before the filter still do so afterwards.
#include "filter/merge/additive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "filter/sequence/sequence_filter.h"
#include "frame/error.h"
#include "tests/filter/denoised.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/guided_frame.h"
#include "tests/filter/pattern.h"

namespace becalm::filter::additive_test {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const std::vector<std::string> kGroups{"key", "rim", "sky"};

/// A pattern with albedo 0.04 to 1 that moves by (1.3, -0.6) px per frame, under skewed noise with fireflies.
/// Three light groups light it, each with its own noise and edge; the first is the direct light, the others
/// the indirect.
Frame noisy_frame(int number, int width = kWidth, int height = kHeight) {
  std::mt19937 random(number);
  std::exponential_distribution<float> exponential;
  const auto u_of = [&](int x) { return x + 1.3 * number; };
  const auto v_of = [&](int y) { return y - 0.6 * number; };
  Frame frame = guided_frame(number, width, height, [&](int x, int y) {
    SurfacePixel surface{
        .albedo = {}, .normal_z = 1.0f, .depth = static_cast<float>(4.0 + pattern(u_of(x), v_of(y), 3))};
    for (int c = 0; c < 3; ++c) {
      surface.albedo[c] = static_cast<float>(0.04 + 0.96 * pattern(u_of(x), v_of(y), 9 + c));
    }
    return surface;
  });
  for (const Aov half : {Aov::half_a, Aov::half_b, Aov::direct, Aov::indirect}) frame.add(half);
  for (const std::string& name : kGroups) {
    frame.light_groups().push_back({name, Image(width, height, 3)});
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        float halves[2] = {};
        for (std::size_t g = 0; g < kGroups.size(); ++g) {
          const float firefly = random() % 300 == 0 ? 50.0f : 1.0f;
          const float lit = pattern(u_of(x), v_of(y), 20 + static_cast<unsigned>(g)) > 0.5 ? 1.0f : 0.05f;
          const float radiance = firefly * lit * frame.image(Aov::albedo).at(x, y, c);
          const float a = radiance * exponential(random);
          const float b = radiance * exponential(random);
          frame.light_groups()[g].radiance.at(x, y, c) = 0.5f * (a + b);
          frame.image(g == 0 ? Aov::direct : Aov::indirect).at(x, y, c) += 0.5f * (a + b);
          halves[0] += a;
          halves[1] += b;
        }
        frame.image(Aov::half_a).at(x, y, c) = halves[0];
        frame.image(Aov::half_b).at(x, y, c) = halves[1];
        frame.image(Aov::beauty).at(x, y, c) = 0.5f * (halves[0] + halves[1]);
        frame.image(Aov::variance).at(x, y, c) = 0.25f * (halves[0] - halves[1]) * (halves[0] - halves[1]);
      }
    }
  }
  return frame;
}

Frame without_additive(Frame frame) {
  frame.light_groups().clear();
  frame.remove(Aov::direct);
  frame.remove(Aov::indirect);
  return frame;
}

Frame frame_of_usual_size(int number) {
  return noisy_frame(number);
}

bool same_bits(const Image& a, const Image& b) {
  return a.same_shape(b) && std::ranges::equal(a.data(), b.data(), [](float x, float y) {
           return x == y || (std::isnan(x) && std::isnan(y));
         });
}

/// Largest difference between the sum of the images and the beauty, relative to the beauty (or to 1e-3 where
/// it is darker: there the differences are rounding errors next to fireflies).
double largest_difference(const Frame& frame, const std::vector<const Image*>& parts) {
  double largest = 0.0;
  for (std::size_t i = 0; i < frame.image(Aov::beauty).pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double beauty = frame.image(Aov::beauty).data()[4 * i + c];
      double sum = 0.0;
      for (const Image* part : parts) sum += part->data()[3 * i + c];
      largest = std::max(largest, std::abs(sum - beauty) / std::max(std::abs(beauty), 1e-3));
    }
  }
  return largest;
}

double variation(const Image& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 1; x < image.width(); ++x) sum += std::abs(image.at(x, y, 1) - image.at(x - 1, y, 1));
  }
  return sum;
}

class AdditiveTest : public DeviceTest {
 protected:
  static constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

  /// Denoises frames 3 and 4 of the six frames of `frame_of`.
  template <class FrameOf>
  std::vector<Denoised> denoise(const Settings& settings, const FrameOf& frame_of,
                                std::uint64_t memory_limit = kUnlimited) {
    const Frame first = frame_of(1);
    SequenceFilter filter(device(), settings, first.width(), first.height(), first.aovs(),
                          {.memory_limit = memory_limit, .light_groups = first.light_groups().size()});
    memory_ = filter.memory();
    std::vector<Denoised> result;
    for (const Segment& segment : schedule(std::vector{1, 2, 3, 4, 5, 6}, {3, 4},
                                           {.directions = settings.directions,
                                           .segment = settings.directions == Directions::both ? 8 : 0,
                                           .warmup = settings.directions == Directions::both ? 4 : 0})) {
      for (const Step& step : segment) {
        Denoised denoised;
        std::optional<Frame> frame = filter.run(step, frame_of(step.frame), denoised.report);
        if (!frame) continue;
        denoised.frame = std::move(*frame);
        result.push_back(std::move(denoised));
      }
    }
    return result;
  }

  FilterMemory memory_;
};

TEST_F(AdditiveTest, SumsStayWhatTheyAre) {
  const std::vector<std::vector<std::string>> changes{
      {}, {"resample=bilinear"}, {"smooth=none"}, {"smooth=frames"}, {"merge=mask"}};
  for (const char* name : {"draft", "final"}) {
    for (const std::vector<std::string>& change : changes) {
      Settings settings = preset(name);
      std::string text = name;
      for (const std::string& assignment : change) {
        set(settings, assignment);
        text += ' ' + assignment;
      }
      const std::vector<Denoised> frames = denoise(settings, frame_of_usual_size);
      ASSERT_EQ(frames.size(), 2u);
      for (const Denoised& denoised : frames) {
        const Frame& frame = denoised.frame;
        ASSERT_EQ(frame.light_groups().size(), kGroups.size());
        std::vector<const Image*> groups;
        for (const LightGroup& group : frame.light_groups()) groups.push_back(&group.radiance);
        // Large values cancel beside the fireflies of noisy frames.
        const double bound = settings.smooth == Smooth::none ? 2e-5 : 1e-5;
        EXPECT_LT(largest_difference(frame, groups), bound) << text;
        EXPECT_LT(largest_difference(frame, {&frame.image(Aov::direct), &frame.image(Aov::indirect)}), bound)
            << text;
        if (settings.smooth == Smooth::none) continue;
        const Frame noisy = noisy_frame(frame.number());
        for (std::size_t g = 0; g < kGroups.size(); ++g) {
          EXPECT_EQ(frame.light_groups()[g].name, kGroups[g]);
          EXPECT_LT(variation(*groups[g]), 0.6 * variation(noisy.light_groups()[g].radiance)) << text;
        }
      }
    }
  }
}

TEST_F(AdditiveTest, TheBeautyDoesNotDependOnThem) {
  const std::vector<Denoised> with = denoise(preset("final"), frame_of_usual_size);
  const std::vector<Denoised> without =
      denoise(preset("final"), [](int number) { return without_additive(noisy_frame(number)); });
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_TRUE(same_bits(with[i].frame.image(Aov::beauty), without[i].frame.image(Aov::beauty)));
    EXPECT_FALSE(without[i].frame.has(Aov::direct));
    EXPECT_TRUE(without[i].frame.light_groups().empty());
  }
}

TEST_F(AdditiveTest, ThoseThatOnePassTakesDoNotDependOnEachOther) {
  // The direct light and the first group are the same, and the first and the third of five.
  const std::vector<Denoised> five = denoise(preset("final"), frame_of_usual_size);
  const std::vector<Denoised> one = denoise(preset("final"), [](int number) {
    Frame frame = noisy_frame(number);
    frame.light_groups().clear();
    frame.remove(Aov::indirect);
    return frame;
  });
  for (std::size_t i = 0; i < five.size(); ++i) {
    const Image& direct = five[i].frame.image(Aov::direct);
    EXPECT_TRUE(same_bits(direct, five[i].frame.light_groups()[0].radiance));
    EXPECT_TRUE(same_bits(direct, one[i].frame.image(Aov::direct)));
  }
}

TEST_F(AdditiveTest, TilesDoNotShow) {
  Settings settings = preset("final");
  settings.smooth = Smooth::none;
  settings.pyramid.levels = 1;
  settings.blur_radius = {1};
  const auto large_frame = [](int number) { return noisy_frame(number, 320, 200); };
  const std::vector<Denoised> whole = denoise(settings, large_frame);
  ASSERT_EQ(memory_.tiles, 1u);
  const std::vector<Denoised> tiled = denoise(settings, large_frame, memory_.device.total() / 4);
  ASSERT_GT(memory_.tiles, 1u);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const auto images = additive_images(whole[i].frame, whole[i].frame.aovs());
    const auto others = additive_images(tiled[i].frame, tiled[i].frame.aovs());
    ASSERT_EQ(images.size(), 5u);
    for (std::size_t n = 0; n < images.size(); ++n) EXPECT_TRUE(same_bits(*images[n], *others[n])) << n;
  }
}

TEST_F(AdditiveTest, PixelsThatAreNotFinite) {
  const auto damaged = [](int number) {
    Frame frame = noisy_frame(number);
    frame.image(Aov::beauty).at(10, 20, 1) = kNan;  // some of its AOVs stay finite
    frame.light_groups()[1].radiance.at(10, 20, 1) = kNan;
    frame.light_groups()[2].radiance.at(30, 20, 0) = -INFINITY;  // the beauty is finite here
    frame.image(Aov::direct).at(31, 20, 2) = kNan;
    return frame;
  };
  const std::vector<Denoised> frames = denoise(preset("final"), damaged);
  ASSERT_EQ(frames.size(), 2u);
  for (const Denoised& denoised : frames) {
    const Frame noisy = damaged(denoised.frame.number());
    EXPECT_EQ(denoised.report.non_finite_pixels, 1u);
    EXPECT_EQ(denoised.report.replaced_additive, 2u);
    const auto images = additive_images(denoised.frame, denoised.frame.aovs());
    const auto sources = additive_images(noisy, noisy.aovs());
    for (std::size_t n = 0; n < images.size(); ++n) {
      for (int c = 0; c < 3; ++c) {
        const float value = sources[n]->at(10, 20, c);
        EXPECT_TRUE(images[n]->at(10, 20, c) == value || std::isnan(value));
      }
      const auto count = std::ranges::count_if(images[n]->data(), [](float v) { return !std::isfinite(v); });
      EXPECT_EQ(count, n == 3 ? 1 : 0) << n;  // direct, indirect, key, rim
    }
    EXPECT_TRUE(std::isnan(images[3]->at(10, 20, 1)));
  }
}

TEST_F(AdditiveTest, MayBeLeftOut) {
  const Frame frame = frame_of_usual_size(1);
  SequenceFilter filter(device(), preset("draft"), frame.width(), frame.height(),
                        frame.aovs() & ~additive_aovs());
  const Frame denoised = denoise_frame(filter, frame).frame;
  EXPECT_FALSE(denoised.has(Aov::direct));
  EXPECT_TRUE(denoised.light_groups().empty());
}

TEST_F(AdditiveTest, FramesThatLackAGroupOrHaveAnotherAreRefused) {
  const auto fewer_groups_later = [](int number) {
    Frame frame = noisy_frame(number);
    if (number > 1) frame.light_groups().pop_back();
    return frame;
  };
  EXPECT_THROW(denoise(preset("draft"), fewer_groups_later), Error);
  const auto other_groups_later = [](int number) {
    Frame frame = noisy_frame(number);
    if (number > 1) frame.light_groups().back().name = "another";
    return frame;
  };
  EXPECT_THROW(denoise(preset("draft"), other_groups_later), Error);
}

}  // namespace
}  // namespace becalm::filter::additive_test
