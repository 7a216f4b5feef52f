// The scenes of scenes/: each is described, and renders its first and last frame.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(BECALM_SCENES)) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

class Scenes : public testing::TestWithParam<std::string> {
 protected:
  const std::string scene_ = fmt::format("{}/{}.json", BECALM_SCENES, GetParam());
};

TEST_P(Scenes, AreDescribed) {
  const Outcome outcome = becalm_done({"info", scene_});
  for (const char* word :
       {"frames:    1-24", "film:      640x360", "requires:", "left out:", "variant:", "memory:"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word << " in\n" << outcome.out;
}

TEST_P(Scenes, RenderWithoutAWarningAndWithLight) {
  const TempFolder folder;
  const std::string pattern = folder / "a.####.exr";
  const Outcome outcome = becalm_done({"render", scene_, "-o", pattern, "--frames", "1,24", "--size", "32x18",
                                       "--spp", "2", "--aovs", "all", "--float", "--quiet"});
  EXPECT_EQ(outcome.err, "") << "samples that are not finite are reported here";
  for (const int number : {1, 24}) {
    const Frame frame = read_frame(frame_path(pattern, number), all_aovs());
    double sum = 0.0, direct = 0.0, indirect = 0.0;
    for (int y = 0; y < 18; ++y) {
      for (int x = 0; x < 32; ++x) {
        sum += frame.image(Aov::beauty).at(x, y, 1);
        direct += frame.image(Aov::direct).at(x, y, 1);
        indirect += frame.image(Aov::indirect).at(x, y, 1);
      }
    }
    EXPECT_GT(sum, 0.0);
    EXPECT_NEAR((direct + indirect) / sum, 1.0, 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Scenes, testing::ValuesIn(scene_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace becalm::test
