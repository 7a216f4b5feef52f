#include "tests/filter/footprint_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "filter/ceil_div.h"

namespace becalm {
namespace {

using filter::ceil_div;
using gpu::Chain;
using gpu::DeclaredPass;
using gpu::Footprint;
using gpu::ImageId;
using gpu::Margin;

struct Pixel {
  int x;
  int y;
};

/// The pixels [x0, x1] x [y0, y1].
struct Box {
  int x0, y0, x1, y1;
};

int floor_div(int a, int b) {
  return static_cast<int>(std::floor(static_cast<double>(a) / b));
}

/// How the elements of an image lie. Framed images have an extra pixel around them and the channels of a
/// pixel side by side (smooth/host_features.cpp); they are wide, since frames are square. Others are planes.
struct Layout {
  Layout(const Chain& chain, ImageId image) {
    const gpu::Extent extent = chain.extent(image);
    const gpu::Format format = chain.format(image);
    channels = static_cast<int>(gpu::bytes_per_element(format) / sizeof(float));
    const bool framed = extent.height > 1 && extent.width > extent.height;
    frame = framed ? 1 : 0;
    stride = framed ? extent.height : extent.width;
    side = stride - 2 * frame;
    if (framed) channels *= extent.width / extent.height;
    planes = extent.planes;
  }

  /// The pixel that holds a float; in the extra pixels it lies outside.
  Pixel pixel(std::size_t i) const {
    const int in_plane = static_cast<int>(i / channels) % (stride * stride);
    return {in_plane % stride - frame, in_plane / stride - frame};
  }
  /// Calls `use` with the index of each float of a pixel.
  template <class Use>
  void for_each_float(const Pixel& p, const Use& use) const {
    for (int plane = 0; plane < planes; ++plane) {
      const std::size_t first =
          (static_cast<std::size_t>(plane) * stride + p.y + frame) * stride + p.x + frame;
      for (int c = 0; c < channels; ++c) use(first * channels + c);
    }
  }
  bool contains(const Pixel& p) const { return p.x >= 0 && p.y >= 0 && p.x < side && p.y < side; }
  Pixel clamp(const Pixel& p) const { return {std::clamp(p.x, 0, side - 1), std::clamp(p.y, 0, side - 1)}; }

  int channels;
  int planes;
  int side;    ///< in pixels, without the extra ones
  int stride;  ///< with them
  int frame;   ///< extra pixels on each side
};

class Check {
 public:
  Check(const Chain& chain, std::size_t pass, const TileSizes& sizes)
      : declared_(chain.declared_passes()[pass]), single_(chain.single_pass(pass)) {
    for (const ImageId image : declared_.writes) written_.emplace_back(chain, image);
    for (const auto& [image, footprint] : declared_.reads) {
      layouts_.emplace_back(chain, image);
      if (footprint.kind != Footprint::Kind::gathered) continue;
      const int pixel_px = sizes.target / written_.front().side;
      origin_ = sizes.origin / pixel_px;
      // What the search reads at the start of each level has a limit of its own, which is the footprint.
      offset_limit_ = declared_.name == "align/warp_source" ? footprint.around.left
                                                            : ceil_div(sizes.offset_limit, pixel_px);
    }
    single_.build();
    for (std::size_t r = 0; r < declared_.reads.size(); ++r) upload(r, sizes.origin);
    before_ = run();
  }

  std::vector<std::string> errors() {
    std::set<int> seen;
    for (std::size_t r = 0; r < declared_.reads.size(); ++r) {
      const auto& [image, footprint] = declared_.reads[r];
      const bool is_table = footprint.kind == Footprint::Kind::anywhere;
      if (!is_written(image) && !is_table && seen.insert(image.index).second) check(r);
    }
    return errors_;
  }

 private:
  bool is_written(ImageId image) const {
    return std::ranges::find(declared_.writes, image) != declared_.writes.end();
  }

  float random_value() {
    std::uniform_real_distribution<float> uniform(0.1f, 1.0f);
    return random_() % 20 == 0 ? 20.0f : uniform(random_);
  }

  /// Random values, but offsets that lead as far as they may, to each side in turn.
  void upload(std::size_t r, int origin_px) {
    const auto& [image, footprint] = declared_.reads[r];
    const Layout& layout = layouts_[r];
    if (is_written(image)) return;
    std::vector<float>& values = inputs_[image.index];
    values.resize(single_.upload<float>(image).size());
    const bool is_table = footprint.kind == Footprint::Kind::anywhere;
    const bool is_offset = offset_limit_ && layout.channels == 2 && footprint.kind == Footprint::Kind::local;
    std::uniform_real_distribution<float> weight(-0.5f, 0.5f);
    std::uniform_real_distribution<float> part(0.0f, 1.0f);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Pixel p = layout.pixel(i);
      if (is_offset) {
        const int quarter = 4 * (i % 2 == 0 ? p.x : p.y) / layout.side;
        const float size = static_cast<float>(*offset_limit_) - (random_() % 2 == 0 ? part(random_) : 0.0f);
        values[i] = (quarter % 2 == 0 ? -size : size) * static_cast<float>(footprint.covered) /
                    static_cast<float>(footprint.covering);
      } else if (is_table) {
        values[i] = values.size() == 1   ? 1.0f
                    : values.size() == 2 ? static_cast<float>(origin_px)
                                         : weight(random_);
      } else {
        values[i] = random_value();
      }
    }
  }

  std::vector<std::vector<float>> run() {
    for (const auto& [image, values] : inputs_)
      std::ranges::copy(values, single_.upload<float>(ImageId{image}).begin());
    single_.run();
    std::vector<std::vector<float>> results;
    for (const ImageId image : declared_.writes) {
      const auto pixels = single_.download<float>(image);
      results.emplace_back(pixels.begin(), pixels.end());
    }
    return results;
  }

  /// The pixels of the image of read `r` that written pixel `p` may depend on, also beyond its border.
  Box footprint_of(std::size_t r, const Pixel& p) const {
    std::optional<Box> all;
    for (const auto& [image, f] : declared_.reads) {
      if (image != declared_.reads[r].image) continue;
      const int origin = f.kind == Footprint::Kind::gathered ? origin_ : 0;
      const int run_begin = p.y / f.run_rows * f.run_rows;
      const Box box{floor_div((p.x + origin) * f.covered - f.around.left, f.covering),
                    floor_div((run_begin + origin) * f.covered - f.around.above, f.covering),
                    floor_div((p.x + origin + 1) * f.covered - 1 + f.around.right, f.covering),
                    floor_div((p.y + origin + 1) * f.covered - 1 + f.around.below, f.covering)};
      all = !all ? box
                 : Box{std::min(all->x0, box.x0), std::min(all->y0, box.y0), std::max(all->x1, box.x1),
                       std::max(all->y1, box.y1)};
    }
    return *all;
  }

  /// Pixels to change at once: so far apart that no footprint contains two of them, or one where `gathered`.
  std::vector<Pixel> pixels_to_change(std::size_t r, int trial) {
    const Layout& layout = layouts_[r];
    const Footprint& f = declared_.reads[r].footprint;
    const auto below = [&](int bound) { return static_cast<int>(random_() % static_cast<unsigned>(bound)); };
    if (f.kind == Footprint::Kind::gathered) {
      const int side = written_.front().side;
      const Pixel p{below(side), below(side)};
      const auto there = [&](int at) {
        return at + origin_ + (4 * at / side % 2 == 0 ? -1 : 1) * *offset_limit_ + below(6) - 2;
      };
      return {layout.clamp({there(p.x), there(p.y)})};
    }
    const int step_x = 2 * std::max(f.around.left, f.around.right) + 2 * f.covered + 1;
    const int step_y = f.around.above + f.around.below + 2 * f.covered * f.run_rows + 1;
    // The first trials change the last row that the second run sees of the rows above it.
    const int first_y = f.run_rows > 1 && trial < 8 ? f.run_rows - f.around.above : below(step_y);
    std::vector<Pixel> pixels;
    for (int y = first_y; y < layout.side; y += step_y) {
      for (int x = below(step_x); x < layout.side; x += step_x) pixels.push_back({x, y});
    }
    if (pixels.empty()) pixels.push_back({below(layout.side), below(layout.side)});
    return pixels;
  }

  void check(std::size_t r) {
    const auto& [image, footprint] = declared_.reads[r];
    const bool gathered = footprint.kind == Footprint::Kind::gathered;
    Margin least = {INT_MAX, INT_MAX, INT_MAX, INT_MAX};
    for (int trial = 0; trial < (gathered ? 40 : 16); ++trial) {
      const std::vector<Pixel> pixels = pixels_to_change(r, trial);
      std::vector<float>& values = inputs_[image.index];
      const std::vector<float> kept = values;
      change(layouts_[r], pixels, values);
      const auto after = run();
      values = kept;
      if (!compare(r, pixels, after, least)) return;
    }
    // Offsets lead to within two pixels of a gathered read's limit.
    const auto require = [&](const char* side, int around, int distance) {
      if (around == 0 || distance <= (gathered ? 2 : 0)) return;
      errors_.push_back(fmt::format("{}: read {}: its footprint is larger than what is read {} it",
                                    declared_.name, r, side));
    };
    require("left of", footprint.around.left, least.left);
    require("above", footprint.around.above, least.above);
    require("right of", footprint.around.right, least.right);
    require("below", footprint.around.below, least.below);
  }

  /// Looks for the cause of each change of the results. `least` becomes the smallest distances from causes to
  /// the edges of the footprints.
  bool compare(std::size_t r, const std::vector<Pixel>& pixels, const std::vector<std::vector<float>>& after,
               Margin& least) {
    const Layout& layout = layouts_[r];
    std::vector<bool> is_changed(static_cast<std::size_t>(layout.side) * layout.side);
    for (const Pixel& q : pixels) is_changed[static_cast<std::size_t>(q.y) * layout.side + q.x] = true;
    const auto cause_within = [&](const Pixel& first, const Pixel& last) -> std::optional<Pixel> {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
          if (is_changed[static_cast<std::size_t>(y) * layout.side + x]) return Pixel{x, y};
        }
      }
      return std::nullopt;
    };
    for (std::size_t w = 0; w < written_.size(); ++w) {
      for (std::size_t i = 0; i < after[w].size(); ++i) {
        if (std::bit_cast<std::uint32_t>(after[w][i]) == std::bit_cast<std::uint32_t>(before_[w][i]))
          continue;
        const Pixel p = written_[w].pixel(i);
        if (!written_[w].contains(p)) continue;
        const Box box = footprint_of(r, p);
        const auto cause = cause_within(layout.clamp({box.x0, box.y0}), layout.clamp({box.x1, box.y1}));
        if (!cause) {
          errors_.push_back(fmt::format("{}: read {}: pixel ({}, {}) depends on more than its footprint",
                                        declared_.name, r, p.x, p.y));
          return false;
        }
        least = {std::min(least.left, cause->x - box.x0), std::min(least.above, cause->y - box.y0),
                 std::min(least.right, box.x1 - cause->x), std::min(least.below, box.y1 - cause->y)};
      }
    }
    return true;
  }

  /// Changes every value of the pixels, some to zero.
  void change(const Layout& layout, const std::vector<Pixel>& pixels, std::span<float> values) {
    std::uniform_real_distribution<float> exponent(-2.0f, 3.0f);
    for (const Pixel& p : pixels) {
      const bool is_cleared = random_() % 3 == 0;
      layout.for_each_float(
          p, [&](std::size_t i) { values[i] = is_cleared ? 0.0f : std::pow(10.0f, exponent(random_)); });
    }
  }

  std::mt19937 random_{1};
  DeclaredPass declared_;
  Chain single_;
  std::vector<Layout> written_;
  std::vector<Layout> layouts_;               ///< of the reads
  std::map<int, std::vector<float>> inputs_;  ///< by image
  std::vector<std::vector<float>> before_;
  int origin_ = 0;                   ///< of the target in the images that are gathered from
  std::optional<int> offset_limit_;  ///< of a pass that gathers
  std::vector<std::string> errors_;
};

}  // namespace

std::vector<std::string> wrong_footprints(const Chain& chain, std::size_t pass, const TileSizes& sizes) {
  return Check(chain, pass, sizes).errors();
}

}  // namespace becalm
