// Every pass of every kind of chain reads what its footprints say. A footprint that is too small or larger
// than what counts is found.
#include <functional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "filter/align/align.h"
#include "filter/antialias/antialias_chain.h"
#include "filter/burst/burst_chains.h"
#include "filter/burst/burst_merger.h"
#include "filter/gpu/program.h"
#include "filter/merge/combine.h"
#include "filter/merge/merge_chains.h"
#include "filter/smooth/network.h"
#include "filter/stereo/eye_passes.h"
#include "tests/filter/device_fixture.h"
#include "tests/filter/footprint_check.h"

namespace becalm::filter {
namespace {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

constexpr int kSide = 160;
constexpr Extent kFull{kSide, kSide};

FilterTask task_of(const std::string& preset_name, const std::vector<std::string>& changes = {}) {
  FilterTask task{
      .settings = preset(preset_name), .full = kFull, .used = {}, .diagnostics = {}, .guides = {}};
  for (const std::string& change : changes) set(task.settings, change);
  for (const Aov aov : {Aov::variance, Aov::albedo, Aov::normal, Aov::depth}) {
    task.used.set(static_cast<std::size_t>(aov));
  }
  task.used.set(static_cast<std::size_t>(Aov::motion), task.settings.motion != MotionUse::none);
  task.guides = guides_of(task.settings, task.used);
  task.additive = 1;
  return task;
}

/// Kinds of chains, each given to `use`.
class FootprintsTest : public DeviceTest {
 protected:
  using Use = std::function<void(const Chain&, const TileSizes&)>;

  static void features(const Use& use) {
    for (const char* name : {"draft", "balanced", "final", "paper"}) {
      const FeatureChain made(device(), task_of(name), {.levels = 3, .coarse = 2},
                              FeatureChain::Of::new_frame, kFull);
      use(made.chain, {kSide});
    }
  }

  /// Random pixels show all that a search reads if patches are small, so that shifts to the window's border
  /// are chosen, and every level is refined, so that the other shifts' costs count too.
  static void search_and_merge(const Use& use) {
    const PyramidSplit split{.levels = 3, .coarse = 2};
    use_merge(use, task_of("balanced", {"motion=none", "blur_radius=1,2", "refine_levels=12"}), split, 48);
    use_merge(use, task_of("draft", {"blur_radius=5", "refine_levels=12"}), split, 80);
    use_merge(use, task_of("paper"), {.levels = 2, .coarse = 1}, 16);
    known_motion(use);
  }

  static void network(const Use& use) {
    use_network(use, Frame::single, Convolver::kernels);
    use_network(use, Frame::without_albedo, Convolver::kernels);
    use_network(use, Frame::merged, Convolver::kernels);
    if (device().info().is_processor) use_network(use, Frame::merged, Convolver::host);
  }

  static void estimated_variances(const Use& use) {
    for (const bool albedo : {false, true}) {
      FilterTask task = task_of("balanced");
      task.used.reset(static_cast<std::size_t>(Aov::variance));
      task.used.set(static_cast<std::size_t>(Aov::albedo), albedo);
      Chain chain(device(), "variance");
      const NoisyInputs noisy(chain, task, kFull, NoisyUse::smooth);
      use(chain, {kSide});
    }
  }

  /// The history of antialiasing is never cut, so only passes that read around their pixels matter.
  static void antialiasing(const Use& use) {
    AntialiasTask task{.settings = antialias_preset("best"), .full = kFull, .used = {}, .diagnostics = {}};
    for (const char* change : {"rectify=clamp", "mask=yes", "resample=spline"}) set(task.settings, change);
    for (const Aov aov : {Aov::motion, Aov::depth}) {
      task.used.set(static_cast<std::size_t>(aov));
    }
    const AntialiasChain made(device(), task);
    use(made.chain, {kSide});
    for (const Scale& scale : {Scale{1, 1}, Scale{2, 1}}) {
      task.settings.scale = scale;
      task.settings.checkerboard = true;
      task.sampled = {kSide / scale.numerator, kSide / scale.numerator};
      const AntialiasChain sparse(device(), task);
      use(sparse.chain, {kSide});
    }
  }

  static void combination(const Use& use) {
    Chain chain(device(), "combine");
    const auto estimate = [&](const std::string& name) {
      return std::tuple(chain.input(name + ".color", Format::f32x4, kFull),
                        chain.input(name + ".stats", Format::f32x2, kFull),
                        chain.input(name + ".carried", Format::f32x4, kFull));
    };
    const auto [forward, forward_stats, forward_carried] = estimate("forward");
    const auto [backward, backward_stats, backward_carried] = estimate("backward");
    add_combine_passes(chain, preset("final"), kFull,
                       {.exposure = chain.table("exposure", Format::f32, {1, 1}),
                        .forward_color = forward,
                        .forward_stats = forward_stats,
                        .backward_color = backward,
                        .backward_stats = backward_stats,
                        .forward_carried = {forward_carried},
                        .backward_carried = {backward_carried}});
    use(chain, {kSide});
  }

  static void eyes(const Use& use) {
    constexpr int limit_px = 40;
    constexpr int around_px = limit_px + 8;
    constexpr int source = kSide + 2 * around_px;
    const EyePasses passes(device(), task_of("final"), limit_px, kFull, {source, source});
    use(passes.chain, {.target = kSide, .origin = around_px, .offset_limit = limit_px});
  }

  static void bursts(const Use& use) {
    constexpr int limit_px = 40;
    constexpr int around_px = limit_px + 8;
    constexpr int source = kSide + 2 * around_px;
    const BurstTask task{.aligner = burst_aligner_settings(), .cfa = {}, .full = kFull, .block = 2};
    const BurstAlignPasses align(device(), task);
    use(align.chain, {kSide});
    const BurstChoosePasses choice(device(), task);
    use(choice.chain, {kSide / task.block});
    const BurstMergePasses merge(device(), task, limit_px, kFull, {source, source});
    use(merge.chain, {.target = kSide, .origin = around_px, .offset_limit = limit_px});
  }

  static void check(const Chain& chain, const TileSizes& sizes) { check_passes(chain, sizes, ""); }
  static void check_bursts(const Chain& chain, const TileSizes& sizes) {
    check_passes(chain, sizes, "burst/");
  }
  static void check_antialiasing(const Chain& chain, const TileSizes& sizes) {
    check_passes(chain, sizes, "antialias/");
    check_passes(chain, sizes, "merge/spline");
  }

  /// Passes to which random pixels look invalid throughout: StereoTest and BurstTest compare tiles with whole
  /// frames in their place.
  static bool decides_nothing(const std::string& name) {
    return name == "stereo/check_depth" || name == "burst/warp" || name == "burst/accumulate";
  }

  /// Checks those of a chain's passes whose names begin with `prefix`, but not those that another pass of the
  /// same kernel reads alike.
  static void check_passes(const Chain& chain, const TileSizes& sizes, const std::string& prefix) {
    const std::vector<gpu::DeclaredPass> passes = chain.declared_passes();
    for (std::size_t i = passes.size(); i-- > 0;) {  // finest levels come last
      if (!passes[i].name.starts_with(prefix)) continue;
      if (decides_nothing(passes[i].name)) continue;
      if (!is_new(passes[i]) || passes[i].name == "fill") continue;
      for (const std::string& error : wrong_footprints(chain, i, sizes)) ADD_FAILURE() << error;
    }
  }

 private:
  enum class Frame { single, merged, without_albedo };

  /// The passes that read motion: as a candidate of up to 256 px, and instead of offsets.
  static void known_motion(const Use& use) {
    const FilterTask task = task_of("balanced", {"blur_radius=1,2", "refine_levels=12"});
    constexpr int motion_px = 256;
    constexpr int around_px = motion_px + 16;
    constexpr int side = kSide + 2 * around_px;
    Chain chain(device(), "known motion");
    const ImageId motion = chain.input("motion", Format::f32x2, kFull);
    const ImageId target = chain.input("target", Format::f32, level_extent(task.settings, kFull, 0));
    const ImageId source = chain.input("source", Format::f32, level_extent(task.settings, {side, side}, 0));
    const SearchResult found = add_search_passes(
        chain, task.settings,
        {.levels = {.finest = 0, .end = 2},
         .full = kFull,
         .window = {.full = {side, side}, .target_origin = chain.table("origin", Format::f32x2, {1, 1})},
         .target = {.image = target, .planes = 1},
         .source = {.image = source, .planes = 1},
         .start = {},
         .motion = motion,
         .motion_limit_px = largest_motion_px(task.settings, kFull)});
    const ImageId offset = add_upsample_pass(chain, task.settings, kFull, found.offset);
    add_override_pass(chain, kFull, offset, motion);
    use(chain, {.target = kSide, .origin = around_px, .offset_limit = motion_px});
  }

  /// Sources extend `around_px` beyond the target, which offsets and filters may not leave.
  static void use_merge(const Use& use, const FilterTask& task, const PyramidSplit& split, int around_px) {
    const int source = kSide + 2 * around_px;
    const MergeChain merge(device(), task, split, kFull, {source, source}, /*is_whole_frame=*/false);
    use(merge.chain, {.target = kSide,
                      .origin = around_px,
                      .offset_limit = offset_limit_px(task.settings, {.finest = 0, .end = split.levels})});
  }

  static void use_network(const Use& use, Frame frame, Convolver convolver) {
    FilterTask task = task_of("balanced");
    task.merged = frame == Frame::merged;
    task.used.set(static_cast<std::size_t>(Aov::albedo), frame != Frame::without_albedo);
    Chain chain(device(), "smooth");
    const NoisyInputs noisy(chain, task, kFull, NoisyUse::smooth);
    std::vector<Layered> lights;
    for (const char* name : {"diffuse", "specular"}) {
      if (frame != Frame::merged) break;
      lights.push_back({.merged = chain.input(name, Format::f32x4, kFull),
                        .own = chain.input(std::string("own.") + name, Format::f32x4, kFull)});
    }
    const NetworkPasses network(chain, {embedded_weights(), &embedded_own_share()}, kFull, noisy, true,
                                lights, convolver);
    use(chain, {kSide});
  }

  static bool is_new(const gpu::DeclaredPass& pass) {
    static std::set<std::string> seen;
    std::string key = pass.name;
    for (const auto& read : pass.reads) {
      const gpu::Footprint& f = read.footprint;
      for (const int value : {static_cast<int>(f.kind), f.around.left, f.around.above, f.around.right,
                              f.around.below, f.covered, f.covering, f.run_rows}) {
        key += ' ' + std::to_string(value);
      }
    }
    return seen.insert(key).second;
  }
};

TEST_F(FootprintsTest, OfFeatures) {
  features(check);
}

TEST_F(FootprintsTest, OfTheSearchAndTheMerge) {
  search_and_merge(check);
}

TEST_F(FootprintsTest, OfTheNetwork) {
  network(check);
}

TEST_F(FootprintsTest, OfEstimatedVariances) {
  estimated_variances(check);
}

TEST_F(FootprintsTest, OfAntialiasing) {
  antialiasing(check_antialiasing);
}

TEST_F(FootprintsTest, OfTheCombination) {
  combination(check);
}

TEST_F(FootprintsTest, OfBursts) {
  bursts(check_bursts);
}

TEST_F(FootprintsTest, OfTheEyes) {
  eyes(check);
}

TEST_F(FootprintsTest, AreCheckedOfEveryKernel) {
  std::set<std::string> checked;
  const auto collect = [&](const Chain& chain, const TileSizes&) {
    for (const gpu::DeclaredPass& pass : chain.declared_passes()) checked.insert(pass.name);
  };
  for (const auto& chains :
       {features, search_and_merge, network, estimated_variances, combination, antialiasing, eyes, bursts}) {
    chains(collect);
  }
  for (const gpu::Kernel& kernel : gpu::embedded_kernels()) {
    EXPECT_TRUE(checked.contains(std::string(kernel.name))) << kernel.name;
  }
}

/// A pass that sums three pixels of a row, under another footprint.
std::vector<std::string> errors_under(gpu::Device& device, const gpu::Footprint& footprint) {
  Chain chain(device, "box");
  const ImageId in = chain.input("in", Format::f32x4, kFull);
  chain.pass("merge/box")
      .read("statistics", in, footprint)
      .read("beside", std::nullopt)
      .write("sums", chain.image("out", Format::f32x4, kFull))
      .write("new_beside", chain.image("beside", Format::f32x4, kFull))
      .specialize("radius", 1)
      .specialize("along_y", 0)
      .dispatch(kFull);
  return wrong_footprints(chain, 0, {kSide});
}

TEST_F(FootprintsTest, ThatAreWrongAreFound) {
  EXPECT_TRUE(errors_under(device(), gpu::reach(1, 0)).empty());
  EXPECT_EQ(errors_under(device(), gpu::reach(0, 0)).size(), 1u) << "too small";
  EXPECT_EQ(errors_under(device(), gpu::reach(0, 1)).size(), 1u) << "along the wrong axis";
  EXPECT_EQ(errors_under(device(), gpu::reach(2, 0)).size(), 2u) << "too large to the left and to the right";
  EXPECT_EQ(errors_under(device(), gpu::reach(1)).size(), 2u) << "too large above and below";
}

}  // namespace
}  // namespace becalm::filter
