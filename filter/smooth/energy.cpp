#include "filter/smooth/energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "filter/ceil_div.h"
#include "filter/for_rows.h"
#include "filter/smooth/restorable.h"

namespace becalm::filter {
namespace {

/// Sides of the finest blocks, and of those from which single bright samples no longer rule a block.
constexpr int kFinestBlock = 16;
constexpr int kSteadyBlock = 128;
/// How many times its variance a squared difference must exceed to count, and only the excess does.
constexpr double kSignificance = 4.0;
/// Largest relative change of a block's factor by one level, for each 2 deviations of noise in the
/// difference: what a few bright samples add to a block is few deviations. 1/32 has 1 % less error on
/// held-out shots, but restores less of what is certainly missing.
constexpr double kChangeBeyondNoise = 1.0 / 24.0;
/// Largest relative change by one level, whatever the difference.
constexpr double kLargestOfLevel = 1.0;

using Channels = std::array<double, 3>;

struct Block {
  Channels frame{};       ///< sums of exposed radiance over pixels
  Channels estimate{};    ///< the same, of the estimate
  Channels restorable{};  ///< the same, of the part of the estimate that the factor applies to
  double noise = 0.0;     ///< variance of `frame`, averaged over channels
  int pixels = 0;         ///< that are in the sums
  Channels factor{1.0, 1.0, 1.0};
};

/// Blocks of one size, row by row.
struct BlockGrid {
  BlockGrid(int columns, int rows, int block_px)
      : width(columns), height(rows), block_px(block_px), blocks(static_cast<std::size_t>(columns) * rows) {}

  Block& at(int x, int y) { return blocks[static_cast<std::size_t>(y) * width + x]; }
  const Block& at(int x, int y) const { return blocks[static_cast<std::size_t>(y) * width + x]; }

  int width;
  int height;
  int block_px;
  std::vector<Block> blocks;
};

std::span<const float> row_of(const Image& color, int y) {
  const std::size_t values = static_cast<std::size_t>(color.width()) * color.channels();
  return color.data().subspan(values * static_cast<std::size_t>(y), values);
}

/// A factor, and the light that it applies to.
struct Weighted {
  double factor;
  double light;
};

/// Interpolates between two factors. One that applies to less than kUnseen of the other's light counts less:
/// what traces of light in a black block ask for is nothing for the lit pixels beside it.
class BetweenFactors {
 public:
  BetweenFactors(const Weighted& low, const Weighted& high)
      : low_(low.factor),
        high_(high.factor),
        weight_of_low_(low.light > 0.0 ? low.light / (low.light + kUnseen * high.light) : 0.0),
        weight_of_high_(high.light > 0.0 ? high.light / (high.light + kUnseen * low.light) : 0.0) {}
  double at(double share) const {
    const double weight = mix(weight_of_low_, weight_of_high_, share);
    return weight > 0.0 ? mix(low_, high_, share * weight_of_high_ / weight) : mix(low_, high_, share);
  }

 private:
  double low_;
  double high_;
  double weight_of_low_;
  double weight_of_high_;
};

/// Of a column of blocks.
Weighted factor_in_column(const BlockGrid& grid, int x, const Between& y, std::size_t channel) {
  const auto value = [&](int v) -> Weighted {
    const Block& block = grid.at(x, v);
    return {block.factor[channel], std::max(block.restorable[channel], 0.0)};
  };
  const Weighted low = value(y.low), high = value(y.high);
  return {BetweenFactors(low, high).at(y.share), mix(low.light, high.light, y.share)};
}

double factor_between(const BlockGrid& grid, const Between& x, const Between& y, std::size_t channel) {
  return BetweenFactors(factor_in_column(grid, x.low, y, channel), factor_in_column(grid, x.high, y, channel))
      .at(x.share);
}

/// Variance of the mean of a pixel's channel according to the frame's AOVs; negative or not finite if
/// unknown.
double known_variance(const NewFrame& frame, const FilterTask& task, std::size_t i, std::size_t c) {
  if (contains(task.used, Aov::variance)) return frame.frame.image(Aov::variance).data()[3 * i + c];
  if (!task.has_halves()) return -1.0;
  const double e = 0.5 * (double(frame.frame.image(Aov::half_a).data()[3 * i + c]) -
                          frame.frame.image(Aov::half_b).data()[3 * i + c]);
  return e * e;
}

/// The known variance, else the squared difference from the estimate; averaged over channels.
double pixel_noise(const NewFrame& frame, const FilterTask& task, const Estimate& estimate, std::size_t i) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double known = known_variance(frame, task, i, c);
    sum += std::isfinite(known) && known >= 0.0 ? known : residual_square(frame, estimate, i, c);
  }
  return sum / 3.0;
}

/// Without known variance the noise is the squared difference from the estimate. Missing light adds the
/// square of the block's mean difference to it, which is no noise and is subtracted here.
void leave_out_bias(Block& block) {
  if (block.pixels < 2) return;
  double squares = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double difference = block.frame[c] - block.estimate[c];
    squares += difference * difference / 3.0;
  }
  block.noise = std::max(0.0, block.noise - squares / block.pixels);
}

BlockGrid finest_level(const NewFrame& frame, const FilterTask& task, const Estimate& estimate,
                       const Restorable& restorable) {
  const int width = estimate.color.width();
  const int height = estimate.color.height();
  BlockGrid level(ceil_div(width, kFinestBlock), ceil_div(height, kFinestBlock), kFinestBlock);
  const std::span<const float> beauty = frame.frame.image(Aov::beauty).data();
  const std::span<const float> color = estimate.color.data();
  const double exposure = frame.exposure;
  const auto add_row = [&](int y) {
    const std::vector<double> weights = restorable.weights(row_of(estimate.color, y));
    restorable.for_row(y, [&](std::size_t x, const Allowance& allowed) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (!both_have_data(frame, estimate, i)) return;
      const double share = allowed.share * weights[x];
      Block& block = level.at(static_cast<int>(x) / kFinestBlock, y / kFinestBlock);
      for (std::size_t c = 0; c < 3; ++c) {
        const double e = exposure * color[4 * i + c];
        block.frame[c] += exposure * beauty[4 * i + c];
        block.estimate[c] += e;
        block.restorable[c] += share * e;
      }
      block.noise += exposure * exposure * pixel_noise(frame, task, estimate, i);
      ++block.pixels;
    });
  };
  for_each_in_parallel(level.height, [&](int row) {
    for (int y = row * kFinestBlock; y < std::min((row + 1) * kFinestBlock, height); ++y) add_row(y);
    if (task.variance_known()) return;
    for (int x = 0; x < level.width; ++x) leave_out_bias(level.at(x, row));
  });
  return level;
}

BlockGrid coarser(const BlockGrid& fine) {
  BlockGrid level((fine.width + 1) / 2, (fine.height + 1) / 2, 2 * fine.block_px);
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      Block& block = level.at(x / 2, y / 2);
      const Block& part = fine.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        block.frame[c] += part.frame[c];
        block.estimate[c] += part.estimate[c];
        block.restorable[c] += part.restorable[c];
      }
      block.noise += part.noise;
      block.pixels += part.pixels;
    }
  }
  return level;
}

/// Changes the block's factor towards the one that gives the estimate the frame's mean: by the share of the
/// squared difference that exceeds `noise`. The factor is multiplied or divided by 1 + `largest` at most, and
/// by less where the difference hardly exceeds the noise (kChangeBeyondNoise).
void bring_to_frame(Block& block, double noise, double largest) {
  Channels difference{};
  double squares = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double restored = (block.factor[c] - 1.0) * block.restorable[c];
    difference[c] = block.frame[c] - block.estimate[c] - restored;
    squares += difference[c] * difference[c] / 3.0;
  }
  if (!(squares > noise) || !std::isfinite(squares)) return;
  const double share = 1.0 - noise / squares;
  const double most = 1.0 + std::min(largest, kChangeBeyondNoise * std::sqrt(squares / noise));
  for (std::size_t c = 0; c < 3; ++c) {
    const double base = block.factor[c] * block.restorable[c];
    if (!(base > 0.0)) continue;
    block.factor[c] *= std::clamp(1.0 + share * difference[c] / base, 1.0 / most, most);
  }
}

/// Computes one level's factors from those of the next coarser level, if there is one.
void find_factors(BlockGrid& level, const BlockGrid* coarse) {
  const bool steady = level.block_px >= kSteadyBlock;
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      Block& block = level.at(x, y);
      for (std::size_t c = 0; c < 3 && coarse; ++c) {
        block.factor[c] = factor_between(*coarse, {(x + 0.5) / 2.0 - 0.5, coarse->width},
                                         {(y + 0.5) / 2.0 - 0.5, coarse->height}, c);
      }
      // A small block without a bright sample seems dark and hardly noisy. With the noise of as many pixels
      // of the block around it, it is not darkened.
      double noise = block.noise;
      if (!steady && coarse && block.pixels > 0) {
        const Block& around = coarse->at(x / 2, y / 2);
        noise = std::max(noise, around.noise * block.pixels / around.pixels);
      }
      bring_to_frame(block, kSignificance * noise, kLargestOfLevel);
    }
  }
}

/// Within the range of floats.
void multiply(float& value, float factor) {
  constexpr float largest = std::numeric_limits<float>::max();
  value = std::clamp(value * factor, -largest, largest);
}

/// Multiplies the restorable part of the estimate and of its additive AOVs by the factors, interpolated
/// between the blocks' centres. Calls `use(y)` for each row that is done, on all threads.
template <class Use>
void apply(const BlockGrid& grid, const Restorable& restorable, Estimate& estimate, const Use& use) {
  const int width = estimate.color.width();
  std::vector<Between> columns;
  columns.reserve(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x) columns.emplace_back((x + 0.5) / grid.block_px - 0.5, grid.width);
  const auto scale_row = [&](int y) {
    const Between row((y + 0.5) / grid.block_px - 0.5, grid.height);
    std::vector<std::array<BetweenFactors, 3>> after;  // between a column of blocks and the next
    after.reserve(static_cast<std::size_t>(grid.width));
    for (int x = 0; x < grid.width; ++x) {
      const auto along = [&](std::size_t c) {
        return BetweenFactors(factor_in_column(grid, x, row, c),
                              factor_in_column(grid, std::min(x + 1, grid.width - 1), row, c));
      };
      after.push_back({along(0), along(1), along(2)});
    }
    const std::vector<double> weights = restorable.weights(row_of(estimate.color, y));
    restorable.for_row(y, [&](std::size_t x, const Allowance& allowed) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      const Between& column = columns[x];
      for (std::size_t c = 0; c < 3; ++c) {
        const double of_block = after[column.low][c].at(column.share);
        const auto factor = static_cast<float>(allowed.factor(of_block, weights[x]));
        multiply(estimate.color.data()[4 * i + c], factor);
        for (Image& image : estimate.carried) multiply(image.data()[4 * i + c], factor);
      }
    });
    use(y);
  };
  for_rows(estimate.color.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) scale_row(y);
  });
}

/// Excludes channels whose mean over the frame is not positive. They have no brightness to restore: values of
/// either sign may cancel there.
void leave_channels_without_light(std::vector<BlockGrid>& levels) {
  const Channels whole = levels.back().blocks.front().frame;
  for (BlockGrid& level : levels) {
    for (Block& block : level.blocks) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (!(whole[c] > 0.0)) block.frame[c] = block.estimate[c] = block.restorable[c] = 0.0;
      }
    }
  }
}

/// Exposed sums over a row or the whole frame, once the blocks' factors are applied.
struct Remainder {
  Remainder& operator+=(const Remainder& other) {
    for (std::size_t c = 0; c < 3; ++c) {
      estimate[c] += other.estimate[c];
      restorable[c] += other.restorable[c];
    }
    residual += other.residual;
    return *this;
  }

  Channels estimate{};
  Channels restorable{};  ///< of the part of the estimate that a factor applies to
  double residual = 0.0;  ///< squared difference from the frame, averaged over channels
};

/// `share`: of the pixel that a factor applies to.
void add_pixel(const NewFrame& frame, const Estimate& estimate, std::size_t i, double share, Remainder& sum) {
  if (!both_have_data(frame, estimate, i)) return;
  const double exposure = frame.exposure;
  double residual = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double e = exposure * estimate.color.data()[4 * i + c];
    sum.estimate[c] += e;
    sum.restorable[c] += share * e;
    residual += residual_square(frame, estimate, i, c);
  }
  sum.residual += exposure * exposure * residual / 3.0;
}

/// Changes the mean of the estimate towards that of the noisy frame. `whole` is the coarsest block, with the
/// sums from before the finer levels changed the estimate, `left` has those after it. A frame may state more
/// noise than it has (the variance of one sample may be given as its square), so the residual bounds it. V^2
/// / (V + kUnseen^2) replaces the relative variance V: noise well below kUnseen keeps little back. The
/// change is kUnseen at most.
void restore_whole(Block whole, const Remainder& left, const Restorable& restorable, Estimate& estimate) {
  whole.factor = {1.0, 1.0, 1.0};
  for (std::size_t c = 0; c < 3; ++c) {
    whole.estimate[c] = whole.frame[c] > 0.0 ? left.estimate[c] : 0.0;
    whole.restorable[c] = whole.frame[c] > 0.0 ? left.restorable[c] : 0.0;
  }
  const double mean = (whole.estimate[0] + whole.estimate[1] + whole.estimate[2]) / 3.0;
  const double noise = std::min(whole.noise, left.residual);
  const double unseen = kUnseen * mean * kUnseen * mean;
  bring_to_frame(whole, noise > 0.0 ? noise * (noise / (noise + unseen)) : 0.0, kUnseen);
  BlockGrid one(1, 1, kFinestBlock);
  one.blocks = {whole};
  apply(one, restorable, estimate, [](int) {});
}

}  // namespace

void restore_energy(const NewFrame& frame, const FilterTask& task, Estimate& estimate) {
  const Restorable restorable(frame, estimate);
  std::vector<BlockGrid> levels{finest_level(frame, task, estimate, restorable)};
  while (levels.back().blocks.size() > 1) levels.push_back(coarser(levels.back()));
  leave_channels_without_light(levels);
  for (std::size_t l = levels.size(); l-- > 0;) {
    find_factors(levels[l], l + 1 < levels.size() ? &levels[l + 1] : nullptr);
  }
  std::vector<Remainder> rows(static_cast<std::size_t>(estimate.color.height()));
  apply(levels.front(), restorable, estimate, [&](int y) {
    const std::vector<double> weights = restorable.weights(row_of(estimate.color, y));
    restorable.for_row(y, [&](std::size_t x, const Allowance& allowed) {
      const std::size_t i = weights.size() * static_cast<std::size_t>(y) + x;
      add_pixel(frame, estimate, i, allowed.share * weights[x], rows[static_cast<std::size_t>(y)]);
    });
  });
  Remainder left;
  for (const Remainder& row : rows) left += row;
  restore_whole(levels.back().blocks.front(), left, restorable, estimate);
}

}  // namespace becalm::filter
