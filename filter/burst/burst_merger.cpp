#include "filter/burst/burst_merger.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "filter/burst/burst_chains.h"
#include "filter/burst/global_motion.h"
#include "filter/ceil_div.h"
#include "filter/for_rows.h"
#include "filter/tiles/build_within.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;

namespace {

/// The largest blocks that are matched where smaller ones take too much memory, in those of the pattern.
constexpr int kMostPatternBlocks = 8;
/// Of a tile's chain; larger tiles are no faster.
constexpr std::uint64_t kTileBytes = 512ull << 20;
/// Offsets are clamped to this distance from that of the picture's middle, or to a share of the longer side
/// if that is more, or tiles would need too much of the frame. What lies farther off is rejected by its
/// weight.
constexpr int kFarthestPx = 256;
constexpr int kFarthestShare = 32;

void copy_to(std::span<float> to, std::span<const float> from) {
  std::ranges::copy(from, to.begin());
}

/// Samples that are not finite become white, where they take no part.
Image finite_samples(const Image& samples, float saturated) {
  Image finite = samples;
  const auto values = finite.data();
  for_rows(samples.height(), [&](int begin, int end) {
    const auto width = static_cast<std::size_t>(samples.width());
    for (std::size_t i = begin * width; i < end * width; ++i) {
      if (!std::isfinite(values[i])) values[i] = saturated;
    }
  });
  return finite;
}

}  // namespace

Settings burst_aligner_settings() {
  Settings settings = preset("final");
  settings.match_downsample = 1;  // blocks are pixels to the aligner
  settings.guides = false;
  settings.motion = MotionUse::none;
  settings.distance = Distance::l1;
  settings.blur_radius = {4, 4, 3, 2};
  settings.refine_levels = 12;
  return settings;
}

struct BurstMerger::State {
  State(gpu::Device& device, const Settings& aligner, const CfaPattern& cfa, Extent full,
        std::uint64_t memory_limit)
      : task{.aligner = aligner, .cfa = cfa, .full = full} {
    build_within(memory_limit, [&](std::uint64_t limit) { build(device, limit); });
    set_tables();
  }

  void build(gpu::Device& device, std::uint64_t memory_limit) {
    merge.reset();
    task.block = task.cfa.block();
    plan_search(device, memory_limit);
    limit_px = std::min(align->limit_px,
                        std::max(kFarthestPx, std::max(task.full.width, task.full.height) / kFarthestShare));
    const std::uint64_t left = memory_limit - std::min(search_bytes().own, memory_limit);
    plan_tiles_of_frame(device, left);
    align->chain.build();
    choose->chain.build();
    merge->chain.build();
  }

  /// Blocks are doubled until the search fits.
  void plan_search(gpu::Device& device, std::uint64_t memory_limit) {
    for (;; task.block *= 2) {
      const bool is_last = task.block * 2 > kMostPatternBlocks * task.cfa.block();
      try {
        align.emplace(device, task);
        align->chain.plan();
        choose.emplace(device, task);
        choose->chain.plan();
        if (search_bytes().total() <= memory_limit) return;
        if (is_last)
          throw gpu::DeviceLimitError(frame_too_large(task.full, search_bytes().total(), memory_limit));
      } catch (const gpu::DeviceLimitError&) {
        if (is_last) throw;
      }
    }
  }

  gpu::DeviceBytes search_bytes() const {
    gpu::DeviceBytes bytes = align->chain.device_bytes();
    return bytes += choose->chain.device_bytes();
  }

  void plan_tiles_of_frame(gpu::Device& device, std::uint64_t memory_limit) {
    std::string reason;
    const auto with_limit = [&](std::uint64_t limit) {
      const TileRules rules =
          BurstMergePasses(device, task, limit_px, task.full, task.full).chain.tile_rules();
      return plan_tiles(task.full, rules, [&](const Tile& tile) {
        try {
          merge.emplace(device, task, limit_px, tile.target.extent(), tile.source.extent());
          merge->chain.plan();
        } catch (const gpu::DeviceLimitError& error) {
          reason = error.what();
          return false;
        }
        reason = tiles_too_large(tile, merge->chain.device_bytes().total(), limit);
        return merge->chain.device_bytes().total() <= limit;
      });
    };
    tiles = with_limit(std::min(memory_limit, kTileBytes));
    if (tiles.empty()) tiles = with_limit(memory_limit);
    if (tiles.empty()) throw cannot_be_cut(task.full, reason);
  }

  void set_tables() {
    const auto& colors = task.cfa.colors;
    for (std::size_t i = 0; i < align->chain.upload<float>(align->colors).size(); ++i) {
      align->chain.upload<float>(align->colors)[i] = colors[i];
      merge->chain.upload<float>(merge->colors)[i] = colors[i];
    }
  }

  Levels levels_with(const NoiseModel& noise, float saturated) const {
    return {static_cast<float>(reference_noise.a),
            static_cast<float>(reference_noise.b),
            static_cast<float>(noise.a),
            static_cast<float>(noise.b),
            reference_saturated,
            saturated};
  }

  /// Offsets of the search, regularized.
  void choose_offsets(FrameReport& report) {
    const Extent blocks{ceil_div(task.full.width, task.block), ceil_div(task.full.height, task.block)};
    const Image target = download(align->chain, align->target, blocks, 1);
    const Image source = download(align->chain, align->source, blocks, 1);
    offset = download(align->chain, align->offset, blocks, 2);
    const GlobalMotion motion = fit_global_motion(target, source, offset);
    const Imath::V2d middle = motion.offset(blocks.width / 2, blocks.height / 2, blocks.width, blocks.height);
    shift_px = {shift_of(middle.x, task.full.width), shift_of(middle.y, task.full.height)};
    const auto limited = [&](double in_blocks, int shift) {
      const double least = static_cast<double>(shift - limit_px) / task.block;
      const double most = static_cast<double>(shift + limit_px) / task.block;
      return static_cast<float>(std::clamp(in_blocks, least, most));
    };
    const std::span<float> whole = choose->chain.upload<float>(choose->whole);
    for_rows(blocks.height, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) {
        for (int x = 0; x < blocks.width; ++x) {
          const Imath::V2d at = motion.offset(x, y, blocks.width, blocks.height);
          const std::size_t i = 2 * (static_cast<std::size_t>(y) * blocks.width + x);
          whole[i] = limited(at.x, shift_px.x);
          whole[i + 1] = limited(at.y, shift_px.y);
        }
      }
    });
    copy_to(choose->chain.upload<float>(choose->target), target.data());
    copy_to(choose->chain.upload<float>(choose->source), source.data());
    copy_to(choose->chain.upload<float>(choose->found), offset.data());
    choose->chain.run();
    add_times(report, choose->chain);
    offset = download(choose->chain, choose->offset, blocks, 2);
    // What is farther off is read at another place, differs there, and is rejected.
    const std::span<float> offsets = offset.data();
    for (std::size_t i = 0; i < offsets.size(); i += 2) {
      offsets[i] = limited(offsets[i], shift_px.x);
      offsets[i + 1] = limited(offsets[i + 1], shift_px.y);
    }
  }

  /// Along one axis: the frame's offset in whole pixels.
  int shift_of(double in_blocks, int size) const {
    return static_cast<int>(std::lround(std::clamp<double>(in_blocks * task.block, -size, size)));
  }

  /// What a tile reads of a frame that is shifted.
  Rect shifted_source(const Tile& tile) const {
    const auto along = [](int target, int target_size, int source_size, int shift, int frame) {
      return std::clamp(target - (source_size - target_size) / 2 + shift, 0, frame - source_size);
    };
    const Rect& target = tile.target;
    const Rect& source = tile.source;
    return {along(target.x, target.width, source.width, shift_px.x, task.full.width),
            along(target.y, target.height, source.height, shift_px.y, task.full.height), source.width,
            source.height};
  }

  void merge_tile(const Tile& tile, const Image& frame, const Levels& levels, FrameReport& report) {
    BurstMergePasses& passes = *merge;
    const auto place = [&](gpu::ImageId image, int x, int y) {
      copy_to(passes.chain.upload<float>(image), std::array{static_cast<float>(x), static_cast<float>(y)});
    };
    const int period = task.cfa.period;
    const int block = task.block;
    const Rect source = shifted_source(tile);
    upload(passes.chain, passes.reference, view(std::as_const(reference)), tile.target);
    upload(passes.chain, passes.frame, view(frame), source);
    upload(passes.chain, passes.before, view(std::as_const(accumulated)), tile.target);
    upload(passes.chain, passes.offset, view(std::as_const(offset)),
           {tile.target.x / block, tile.target.y / block, ceil_div(tile.target.width, block),
            ceil_div(tile.target.height, block)});
    copy_to(passes.chain.upload<float>(passes.levels), levels);
    place(passes.target_place, tile.target.x % period, tile.target.y % period);
    place(passes.source_place, source.x % period, source.y % period);
    upload_origin(passes.chain, passes.target_origin, tile.target, source);
    passes.chain.run();
    add_times(report, passes.chain);
    copy_core(passes.chain.download<float>(passes.after), tile, next);
  }

  BurstTask task;
  std::optional<BurstAlignPasses> align;
  std::optional<BurstChoosePasses> choose;
  std::optional<BurstMergePasses> merge;
  std::vector<Tile> tiles;
  int limit_px = 0;        ///< largest component of the offsets that are used, less `shift_px`
  Imath::V2i shift_px{0};  ///< of the last frame: that of the picture's middle

  Image reference;
  NoiseModel reference_noise;
  float reference_saturated = 1.0f;
  Image offset;       ///< of the last frame, in blocks
  Image accumulated;  ///< two channels: weighted sum of samples, sum of weights
  Image next;         ///< with the frame at work
};

BurstMerger::BurstMerger(gpu::Device& device, const Settings& aligner, const CfaPattern& cfa, int width,
                         int height, std::uint64_t memory_limit)
    : state_(std::make_unique<State>(device, aligner, cfa, Extent{width, height}, memory_limit)) {}
BurstMerger::~BurstMerger() = default;
BurstMerger::BurstMerger(BurstMerger&&) noexcept = default;

void BurstMerger::start(const BurstFrame& reference, const std::array<float, 3>& white_balance) {
  State& s = *state_;
  const Extent full = s.task.full;
  s.reference = finite_samples(reference.samples, reference.saturated);
  s.reference_noise = reference.noise;
  s.reference_saturated = reference.saturated;
  copy_to(s.merge->chain.upload<float>(s.merge->weights), cfa_weights(s.task.cfa, white_balance));
  s.accumulated = Image(full.width, full.height, 2, 1.0f);
  const auto sums = s.accumulated.data();
  const auto samples = s.reference.data();
  for (std::size_t i = 0; i < samples.size(); ++i) sums[2 * i] = samples[i];
  s.next = Image(full.width, full.height, 2);
}

void BurstMerger::add(const BurstFrame& frame, FrameReport& report) {
  State& s = *state_;
  const Image samples = finite_samples(frame.samples, frame.saturated);
  const Levels levels = s.levels_with(frame.noise, frame.saturated);
  BurstAlignPasses& passes = *s.align;
  copy_to(passes.chain.upload<float>(passes.reference), s.reference.data());
  copy_to(passes.chain.upload<float>(passes.frame), samples.data());
  copy_to(passes.chain.upload<float>(passes.levels), levels);
  passes.chain.run();
  add_times(report, passes.chain);
  s.choose_offsets(report);
  for (const Tile& tile : s.tiles) s.merge_tile(tile, samples, levels, report);
  std::swap(s.accumulated, s.next);
}

Image BurstMerger::offset() const {
  Image in_pixels = state_->offset;
  for (float& value : in_pixels.data()) value *= static_cast<float>(state_->task.block);
  return in_pixels;
}

int BurstMerger::block() const {
  return state_->task.block;
}

Image BurstMerger::merged() const {
  const Image& sums = state_->accumulated;
  Image result(sums.width(), sums.height(), 1);
  const auto values = result.data();
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = sums.data()[2 * i] / sums.data()[2 * i + 1];
  return result;
}

double BurstMerger::mean_weight() const {
  const Image& sums = state_->accumulated;
  const double sum = sum_of_rows<double>(sums.height(), [&](int y) {
    double of_row = 0.0;
    for (int x = 0; x < sums.width(); ++x) of_row += sums.at(x, y, 1);
    return of_row;
  });
  return sum / static_cast<double>(sums.pixel_count());
}

FilterMemory BurstMerger::memory() const {
  FilterMemory memory{.tiles = state_->tiles.size(),
                      .tile = state_->tiles.front().target.extent(),
                      .tile_plan = describe(state_->tiles)};
  add_memory(memory, state_->align->chain);
  add_memory(memory, state_->choose->chain);
  add_memory(memory, state_->merge->chain);
  return memory;
}

}  // namespace becalm::filter
