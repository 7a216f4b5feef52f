// A frame of everything is the same, bit for bit, however it was rendered.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "tests/tracer/everything_scene.h"
#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {
namespace {

RenderOptions all_aovs(int spp) {
  RenderOptions o = options(spp);
  for (const AovInfo& entry : kAovTable) o.aovs.set(static_cast<std::size_t>(entry.aov), !entry.diagnostic);
  o.light_groups = true;
  return o;
}

bool same_bits(const Image& a, const Image& b) {
  return a.data().size() == b.data().size() &&
         (a.empty() || std::memcmp(a.data().data(), b.data().data(), a.data().size_bytes()) == 0);
}

void expect_equal(const Frame& a, const Frame& b, const std::string& what) {
  for (const AovInfo& entry : kAovTable)
    EXPECT_TRUE(same_bits(a.image(entry.aov), b.image(entry.aov))) << what << ": " << entry.name;
  ASSERT_EQ(a.light_groups().size(), b.light_groups().size());
  for (std::size_t i = 0; i < a.light_groups().size(); ++i)
    EXPECT_TRUE(same_bits(a.light_groups()[i].radiance, b.light_groups()[i].radiance)) << what;
}

TEST(EqualImages, ForAnyThreadsAndTiles) {
  Scene scene = load_text(everything_scene());
  EXPECT_TRUE(scene.needs().motion_blur && scene.needs().depth_of_field && scene.needs().media &&
              scene.needs().procedurals && scene.needs().alpha && scene.needs().textures &&
              scene.needs().relief);
  RenderOptions o = all_aovs(2);
  const Frame first = render_frame(scene, 2, o).value();
  EXPECT_GT(mean_radiance(first).value, 0.05);
  for (const int threads : {1, 2, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    o.tile_px = threads == 1 ? 7 : threads == 2 ? 16 : 32;
    expect_equal(first, render_frame(scene, 2, o).value(), std::to_string(threads) + " threads");
  }
}

TEST(EqualImages, WhateverWasRenderedOrBuiltBefore) {
  const std::string json = everything_scene();
  Scene walked = load_text(json);
  for (const int number : {1, 5, 3}) {
    Scene fresh = load_text(json);
    expect_equal(render_frame(walked, number, all_aovs(2)).value(),
                 render_frame(fresh, number, all_aovs(2)).value(), "frame " + std::to_string(number));
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  Scene alone = load_text(json);  // hierarchies built by one thread
  expect_equal(render_frame(walked, 3, all_aovs(2)).value(), render_frame(alone, 3, all_aovs(2)).value(),
               "one thread");
}

}  // namespace
}  // namespace becalm::tracer::test
