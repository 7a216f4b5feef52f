#include "filter/gpu/tile_rules.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>

namespace becalm::gpu {

namespace {

/// The pixels of an image that are needed, in its own pixels. Cores begin at multiples of every image's
/// pixel.
struct Need {
  int pixel_px = 0;
  std::optional<Margin> around_core;
  std::optional<Margin> around_target;  ///< of images that passes gather from
};

Margin larger(const Margin& a, const Margin& b) {
  return {.left = std::max(a.left, b.left),
          .above = std::max(a.above, b.above),
          .right = std::max(a.right, b.right),
          .below = std::max(a.below, b.below)};
}

void raise(std::optional<Margin>& margin, const Margin& other) {
  margin = margin ? larger(*margin, other) : other;
}

/// What a pass reads for written pixels with this margin.
Margin read_for(const Margin& written, const Footprint& footprint) {
  const auto side = [&](int margin, int around) {
    const int in_smaller_pixels = margin * footprint.covered + around;
    return (in_smaller_pixels + footprint.covering - 1) / footprint.covering;
  };
  return {.left = side(written.left, footprint.around.left),
          // A run may begin up to run_rows - 1 rows above the first pixel that is needed.
          .above = side(written.above + footprint.run_rows - 1, footprint.around.above),
          .right = side(written.right, footprint.around.right),
          .below = side(written.below, footprint.around.below)};
}

Margin scaled(const Margin& margin, int factor) {
  return {margin.left * factor, margin.above * factor, margin.right * factor, margin.below * factor};
}

class Backwards {
 public:
  void need(int image, int pixel_px, const std::optional<Margin>& around_core,
            const std::optional<Margin>& around_target) {
    Need& need = needs_[image];
    if (need.pixel_px != 0 && need.pixel_px != pixel_px) {
      throw FootprintError(image, "has pixels of " + std::to_string(need.pixel_px) + " and of " +
                                      std::to_string(pixel_px) + " px");
    }
    need.pixel_px = pixel_px;
    if (around_core) raise(need.around_core, *around_core);
    if (around_target) raise(need.around_target, *around_target);
    core_grid_ = std::lcm(core_grid_, pixel_px);
  }

  void go_through(const PassFootprints& pass) {
    Need made;
    for (const int image : pass.writes) {
      require_no_table(pass, image);
      const auto found = needs_.find(image);
      if (found == needs_.end()) continue;
      const Need& need = found->second;
      if (made.pixel_px != 0 && made.pixel_px != need.pixel_px) {
        throw FootprintError(image, "is written by a pass that also writes pixels of another size");
      }
      made.pixel_px = need.pixel_px;
      if (need.around_core) raise(made.around_core, *need.around_core);
      if (need.around_target) raise(made.around_target, *need.around_target);
    }
    if (made.pixel_px == 0) return;  // nothing reads what it writes
    for (const auto& [image, footprint] : pass.reads) add_read(made, image, footprint);
  }

  /// Images that passes write count as well: they span the tile's rectangles, like inputs, and some depend on
  /// the source alone.
  TileRules rules() const {
    TileRules rules{.grid = std::lcm(core_grid_, run_grid_), .core_grid = core_grid_};
    for (const auto& [image, need] : needs_) {
      if (need.around_core) rules.margin = larger(rules.margin, scaled(*need.around_core, need.pixel_px));
      if (!need.around_target) continue;
      const Margin reach = scaled(*need.around_target, need.pixel_px);
      rules.reach = std::max({rules.reach, reach.left, reach.above, reach.right, reach.below});
    }
    return rules;
  }

 private:
  void add_read(const Need& made, int image, const Footprint& footprint) {
    if (footprint.kind == Footprint::Kind::anywhere) {
      tables_.insert(image);
      return;
    }
    const int pixel_px = made.pixel_px * footprint.covering;
    if (pixel_px % footprint.covered != 0) {
      throw FootprintError(image, "has pixels smaller than the frame's");
    }
    run_grid_ = std::lcm(run_grid_, footprint.run_rows * made.pixel_px);
    if (footprint.kind == Footprint::Kind::gathered) {
      need(image, pixel_px / footprint.covered, std::nullopt, footprint.around);
      return;
    }
    const auto read = [&](const std::optional<Margin>& written) {
      return written ? std::optional(read_for(*written, footprint)) : std::nullopt;
    };
    need(image, pixel_px / footprint.covered, read(made.around_core), read(made.around_target));
  }

  void require_no_table(const PassFootprints& pass, int image) const {
    if (!tables_.contains(image)) return;
    const bool is_made_of_tables = std::ranges::all_of(pass.reads, [](const PassFootprints::Read& read) {
      return read.footprint.kind == Footprint::Kind::anywhere;
    });
    if (is_made_of_tables) return;
    throw FootprintError(image, "is read anywhere and depends on images that are cut");
  }

  std::map<int, Need> needs_;
  std::set<int> tables_;
  int core_grid_ = 1;
  int run_grid_ = 1;
};

}  // namespace

TileRules tile_rules(std::span<const PassFootprints> passes, std::span<const OutputScale> outputs) {
  Backwards backwards;
  for (const OutputScale& output : outputs)
    backwards.need(output.image, output.pixel_px, Margin{}, std::nullopt);
  for (std::size_t i = passes.size(); i-- > 0;) backwards.go_through(passes[i]);
  return backwards.rules();
}

TileRules rules_for_both(const TileRules& a, const TileRules& b) {
  return {.grid = std::lcm(a.grid, b.grid),
          .core_grid = std::lcm(a.core_grid, b.core_grid),
          .margin = larger(a.margin, b.margin),
          .reach = std::max(a.reach, b.reach)};
}

}  // namespace becalm::gpu
