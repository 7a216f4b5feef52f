// --reproducible: the same pixels whatever instructions the libraries would choose.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/end_to_end/denoise_fixture.h"
#include "tests/end_to_end/suite_fixture.h"

namespace becalm::test {
namespace {

/// Environments in which libraries choose other instructions than those of this processor.
const std::string kOldProcessor =
    "ONEDNN_MAX_CPU_ISA=SSE41 LP_NATIVE_VECTOR_WIDTH=128 "
    "ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0 LD_PRELOAD=" BECALM_EMBREE_SSE42;
const std::string kThisProcessor = "ONEDNN_MAX_CPU_ISA=ALL";

void run_on(const std::string& environment, const std::vector<std::string>& arguments) {
  const Outcome outcome = Process(arguments, "exec env " + environment + " \"$0\" \"$@\"").wait();
  EXPECT_EQ(outcome.status, 0) << outcome.command << outcome.err;
}

/// Where it has no more than the old one, there is nothing that could differ without the option.
bool processor_is_newer() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

/// Runs on both, with --reproducible and without. Returns whether frames differ without it: otherwise the
/// environments would not change anything, and the rest would tell nothing.
bool expect_reproducible(const TempFolder& folder, std::vector<std::string> command, AovSet aovs) {
  command.insert(command.end(), {"--device", "llvmpipe", "-o", ""});
  const auto pixels = [&](const std::string& environment, const std::string& name) {
    command.back() = folder / (name + ".####.exr");
    run_on(environment, command);
    return read_frame(folder / (name + ".0001.exr"), aovs);
  };
  const Frame free_old = pixels(kOldProcessor, "free_old");
  const Frame free_new = pixels(kThisProcessor, "free_new");
  command.insert(command.begin() + 1, "--reproducible");
  const Frame pinned_old = pixels(kOldProcessor, "pinned_old");
  const Frame pinned_new = pixels(kThisProcessor, "pinned_new");
  for (const AovInfo& entry : kAovTable) {
    EXPECT_TRUE(same_pixels(pinned_old.image(entry.aov), pinned_new.image(entry.aov))) << entry.name;
    EXPECT_TRUE(same_pixels(pinned_old.image(entry.aov), free_old.image(entry.aov))) << entry.name;
  }
  return !same_pixels(free_old.image(Aov::beauty), free_new.image(Aov::beauty));
}

TEST(Reproducible, RendersDoNotDependOnTheProcessor) {
  const TempFolder folder;
  const bool differ =
      expect_reproducible(folder,
                          {"render", write_scene(folder), "--frames", "1", "--spp", "8", "--aovs", "all",
                           "--float", "--denoise=draft", "--context", "none"},
                          all_aovs());
  EXPECT_EQ(differ, processor_is_newer());
}

TEST_F(Denoise, ReproducibleFramesDoNotDependOnTheProcessor) {
  write_frames({1, 2});
  // Of small frames in half floats a preset may come out alike by chance.
  bool differ = false;
  for (const char* preset : {"draft", "balanced", "final"}) {
    differ |= expect_reproducible(folder_, {"denoise", input_, "--frames", "1", "--preset", preset}, {});
  }
  EXPECT_EQ(differ, processor_is_newer());
}

TEST_F(SuiteTest, ReproducibleReferencesHoldOnOtherProcessors) {
  write_suite(R"("a": {"source": {"scene": "scene.json", "spp": 4}, "judged_by": {"exact": true}})");
  run_on(kOldProcessor, {"test", suite_, "--update", "--yes", "--reproducible"});
  run_on(kThisProcessor, {"test", suite_, "--reproducible"});
}

}  // namespace
}  // namespace becalm::test
