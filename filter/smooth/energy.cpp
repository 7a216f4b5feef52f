#include "filter/smooth/energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "filter/ceil_div.h"

namespace becalm::filter {
namespace {

/// Smoothing leaves outliers out, which are all that smaller blocks would get back: ragged light where it was
/// smooth.
constexpr int kFinestBlock = 128;
/// No level changes a block by more than this.
constexpr double kLargestFactor = 2.0;
/// Relative noise of the whole frame's mean that is not waited for, and the most that the frame is brightened
/// by at last: a difference between frames that is hardly seen, while a bias of as much is a darker shot.
constexpr double kUnseen = 0.01;

struct Block {
  std::array<double, 3> frame{};     ///< sums over pixels, exposed
  std::array<double, 3> estimate{};  ///< the same
  double noise = 0.0;                ///< variance of `frame`, averaged over channels
  std::array<double, 3> factor{1.0, 1.0, 1.0};
};

/// Blocks of one size, row by row.
struct BlockGrid {
  int width = 0;
  int height = 0;
  std::vector<Block> blocks;

  Block& at(int x, int y) { return blocks[static_cast<std::size_t>(y) * width + x]; }
  const Block& at(int x, int y) const { return blocks[static_cast<std::size_t>(y) * width + x]; }

  /// The factor at a position in blocks from the centre of the first one, bilinearly.
  double factor(double x, double y, std::size_t channel) const {
    const double cx = std::clamp(x, 0.0, width - 1.0);
    const double cy = std::clamp(y, 0.0, height - 1.0);
    const int x0 = static_cast<int>(cx);
    const int y0 = static_cast<int>(cy);
    const int x1 = std::min(x0 + 1, width - 1);
    const int y1 = std::min(y0 + 1, height - 1);
    const auto value = [&](int u, int v) { return at(u, v).factor[channel]; };
    return std::lerp(std::lerp(value(x0, y0), value(x1, y0), cx - x0),
                     std::lerp(value(x0, y1), value(x1, y1), cx - x0), cy - y0);
  }
};

/// Square of what a channel of the frame's pixel has beside the estimate.
double residual_square(const NewFrame& frame, const Estimate& estimate, std::size_t i, std::size_t c) {
  const double x = frame.frame.image(Aov::beauty).data()[4 * i + c];
  const double e = x - estimate.color.data()[4 * i + c];
  return e * e;
}

/// Variance of the mean of a pixel's channel as the frame tells it; negative or not finite if it does not.
double told_noise(const NewFrame& frame, const FilterTask& task, std::size_t i, std::size_t c) {
  if (task.has_halves()) {
    const double e = 0.5 * (double(frame.frame.image(Aov::half_a).data()[3 * i + c]) -
                            frame.frame.image(Aov::half_b).data()[3 * i + c]);
    return e * e;
  }
  return contains(task.used, Aov::variance) ? frame.frame.image(Aov::variance).data()[3 * i + c] : -1.0;
}

/// Averaged over channels: what the frame tells, else what the pixel has beside the estimate.
double pixel_noise(const NewFrame& frame, const FilterTask& task, const Estimate& estimate, std::size_t i) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double told = told_noise(frame, task, i, c);
    sum += (std::isfinite(told) && told >= 0.0 ? told : residual_square(frame, estimate, i, c)) / 3.0;
  }
  return sum;
}

/// Whether both the frame and the estimate know a pixel.
bool counts(const NewFrame& frame, const Estimate& estimate, std::size_t i) {
  return frame.finite[i] && estimate.stats.data()[2 * i + 1] > 0.0f;
}

BlockGrid finest_level(const NewFrame& frame, const FilterTask& task, const Estimate& estimate) {
  const int width = estimate.color.width();
  const int height = estimate.color.height();
  BlockGrid level{
      .width = ceil_div(width, kFinestBlock), .height = ceil_div(height, kFinestBlock), .blocks = {}};
  level.blocks.resize(static_cast<std::size_t>(level.width) * level.height);
  const std::span<const float> beauty = frame.frame.image(Aov::beauty).data();
  const std::span<const float> color = estimate.color.data();
  const double exposure = frame.exposure;
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, ++i) {
      if (!counts(frame, estimate, i)) continue;
      Block& block = level.at(x / kFinestBlock, y / kFinestBlock);
      for (std::size_t c = 0; c < 3; ++c) {
        block.frame[c] += exposure * beauty[4 * i + c];
        block.estimate[c] += exposure * color[4 * i + c];
      }
      block.noise += exposure * exposure * pixel_noise(frame, task, estimate, i);
    }
  }
  return level;
}

BlockGrid coarser(const BlockGrid& fine) {
  BlockGrid level{.width = (fine.width + 1) / 2, .height = (fine.height + 1) / 2, .blocks = {}};
  level.blocks.resize(static_cast<std::size_t>(level.width) * level.height);
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      Block& block = level.at(x / 2, y / 2);
      const Block& part = fine.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        block.frame[c] += part.frame[c];
        block.estimate[c] += part.estimate[c];
      }
      block.noise += part.noise;
    }
  }
  return level;
}

/// Brings the block's factor to where the estimate has the frame's mean, by the share of the difference that
/// is more than `noise`, its variance, and by no more than `largest` times or part.
void bring_to_frame(Block& block, double noise, double largest) {
  std::array<double, 3> difference{};
  double squares = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    difference[c] = block.frame[c] - block.factor[c] * block.estimate[c];
    squares += difference[c] * difference[c] / 3.0;
  }
  if (!(squares > noise) || !std::isfinite(squares)) return;
  const double share = 1.0 - noise / squares;
  for (std::size_t c = 0; c < 3; ++c) {
    const double base = block.factor[c] * block.estimate[c];
    if (!(base > 0.0)) continue;
    block.factor[c] *= std::clamp(1.0 + share * difference[c] / base, 1.0 / largest, largest);
  }
}

/// Decides one level's factors, given those of the next coarser one, if there is one. The difference between
/// frame and estimate has this share of the frame's noise.
void find_factors(BlockGrid& level, const BlockGrid* coarse, double share_of_noise) {
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      Block& block = level.at(x, y);
      for (std::size_t c = 0; c < 3 && coarse; ++c) {
        block.factor[c] = coarse->factor((x + 0.5) / 2.0 - 0.5, (y + 0.5) / 2.0 - 0.5, c);
      }
      bring_to_frame(block, share_of_noise * block.noise, kLargestFactor);
    }
  }
}

/// Multiplies the estimate and its additive AOVs by what lies between the factors at the blocks' centres.
void apply(const BlockGrid& finest, Estimate& estimate) {
  const std::span<float> color = estimate.color.data();
  std::size_t i = 0;
  for (int y = 0; y < estimate.color.height(); ++y) {
    const double v = (y + 0.5) / kFinestBlock - 0.5;
    for (int x = 0; x < estimate.color.width(); ++x, ++i) {
      const double u = (x + 0.5) / kFinestBlock - 0.5;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto factor = static_cast<float>(finest.factor(u, v, c));
        color[4 * i + c] *= factor;
        for (Image& image : estimate.additive) image.data()[4 * i + c] *= factor;
      }
    }
  }
}

/// A channel whose mean over the frame is not positive has no brightness to restore: additive AOVs of either
/// sign may cancel there.
void leave_channels_without_light(std::vector<BlockGrid>& levels) {
  const std::array<double, 3> whole = levels.back().blocks.front().frame;
  for (BlockGrid& level : levels) {
    for (Block& block : level.blocks) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (!(whole[c] > 0.0)) block.frame[c] = block.estimate[c] = 0.0;
      }
    }
  }
}

/// Brings the mean of the whole frame to that of the noisy one, given its block as it was before the finer
/// ones were: those with a bright sample are noisier than others, take less of their difference, and light is
/// missing again. Frames may tell more noise than they have, above all those of one sample, whose variance is
/// its square: what the estimate does not explain bounds it. Noise that is not seen is not waited for:
/// V^2 / (V + kUnseen^2) stands for the variance V.
void restore_whole(Block whole, double share_of_noise, const NewFrame& frame, Estimate& estimate) {
  whole.estimate = {};
  whole.factor = {1.0, 1.0, 1.0};
  const double exposure = frame.exposure;
  double residual = 0.0;
  for (std::size_t i = 0; i < frame.finite.size(); ++i) {
    if (!counts(frame, estimate, i)) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      if (whole.frame[c] > 0.0) whole.estimate[c] += exposure * estimate.color.data()[4 * i + c];
      residual += exposure * exposure * residual_square(frame, estimate, i, c) / 3.0;
    }
  }
  const double mean = (whole.estimate[0] + whole.estimate[1] + whole.estimate[2]) / 3.0;
  const double noise = share_of_noise * std::min(whole.noise, residual);
  const double unseen = kUnseen * mean * kUnseen * mean;
  bring_to_frame(whole, noise > 0.0 ? noise * (noise / (noise + unseen)) : 0.0, 1.0 + kUnseen);
  apply({.width = 1, .height = 1, .blocks = {whole}}, estimate);
}

}  // namespace

void restore_energy(const NewFrame& frame, const FilterTask& task, Estimate& estimate, double reach_px) {
  std::vector<BlockGrid> levels{finest_level(frame, task, estimate)};
  while (levels.back().blocks.size() > 1) levels.push_back(coarser(levels.back()));
  leave_channels_without_light(levels);
  const auto share_of_noise = [&](std::size_t l) {
    return std::min(4.0 * reach_px / std::ldexp(kFinestBlock, static_cast<int>(l)), 1.0);
  };
  for (std::size_t l = levels.size(); l-- > 0;) {
    find_factors(levels[l], l + 1 < levels.size() ? &levels[l + 1] : nullptr, share_of_noise(l));
  }
  apply(levels.front(), estimate);
  restore_whole(levels.back().blocks.front(), share_of_noise(levels.size() - 1), frame, estimate);
}

}  // namespace becalm::filter
