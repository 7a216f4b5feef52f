#pragma once

// The chains that align and merge the frames of a burst; burst_merger.cpp runs them in order.

#include <array>

#include "filter/burst/cfa_weights.h"
#include "filter/gpu/chain.h"
#include "filter/settings.h"
#include "frame/mosaic.h"

namespace becalm::filter {

/// What the passes depend on.
struct BurstTask {
  Settings aligner;
  CfaPattern cfa;
  gpu::Extent full;  ///< of the mosaics
  int block = 2;     ///< side of the blocks that are matched, a multiple of cfa.block()
};

/// Noise models and saturation values of the reference and of a frame, in the order of
/// shaders/lib/mosaic.glsl.
using Levels = std::array<float, 6>;

/// The search for a frame's offsets from the reference, on blocks of whole mosaics.
struct BurstAlignPasses {
  BurstAlignPasses(gpu::Device& device, const BurstTask& task);

  gpu::Chain chain;
  gpu::ImageId reference;  ///< f32: mosaic
  gpu::ImageId frame;      ///< f32: mosaic
  gpu::ImageId colors;     ///< f32: the pattern
  gpu::ImageId levels;
  gpu::ImageId target;  ///< f32, a pixel a block: what is matched
  gpu::ImageId source;
  gpu::ImageId offset;  ///< f32x2, a pixel a block, in blocks: frame(p + offset) looks like reference(p)
  int limit_px = 0;     ///< largest component of the offsets, in pixels of the mosaics
};

/// For each block the offset of the motion of the whole picture, or the one that the search found where that
/// is closer.
struct BurstChoosePasses {
  BurstChoosePasses(gpu::Device& device, const BurstTask& task);

  gpu::Chain chain;
  gpu::ImageId target;  ///< as BurstAlignPasses has them
  gpu::ImageId source;
  gpu::ImageId found;
  gpu::ImageId whole;
  gpu::ImageId offset;
};

/// The merge of a frame into a tile of the reference.
struct BurstMergePasses {
  BurstMergePasses(gpu::Device& device, const BurstTask& task, int limit_px, gpu::Extent target,
                   gpu::Extent source);

  gpu::Chain chain;
  gpu::ImageId reference;  ///< f32: mosaic
  gpu::ImageId frame;      ///< f32: mosaic, of the source rectangle
  gpu::ImageId offset;     ///< as BurstAlignPasses has it
  gpu::ImageId before;     ///< f32x2: weighted sum of samples, sum of weights
  gpu::ImageId after;
  gpu::ImageId colors;
  gpu::ImageId weights;  ///< f32: cfa_weights
  gpu::ImageId levels;
  gpu::ImageId target_place;   ///< f32x2, 1x1: of the target's first pixel in the pattern
  gpu::ImageId source_place;   ///< the same of the source's
  gpu::ImageId target_origin;  ///< f32x2, 1x1: of the target's first pixel in the source
};

/// Radius of the patches of blocks whose differences decide on offsets.
constexpr int kChoicePatchRadius = 3;
/// Radius of the patches of samples whose differences decide on weights. A radius of 3: RMSE 1 % more where
/// things move, and equal elsewhere (courtyard, spheres).
constexpr int kMergePatchRadius = 2;

}  // namespace becalm::filter
