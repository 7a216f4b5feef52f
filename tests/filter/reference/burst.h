#pragma once

// The merge of a burst's frame in plain double, written to be read: the oracle for shaders/burst/.

#include <span>

#include "frame/mosaic.h"
#include "tests/filter/reference/grid.h"

namespace becalm::reference {

struct BurstLevels {
  NoiseModel reference_noise;
  NoiseModel frame_noise;
  double reference_saturated = 1.0;
  double frame_saturated = 1.0;
  double balance[3] = {1, 1, 1};
};

struct Read {
  double value = 0.0;
  double ratio = 0.0;  ///< of its variance to a sample's; 0 where nothing can be read
};

/// A colour of a mosaic between its pixels, by filter::cfa_weights.
Read read(const Grid<double>& mosaic, const CfaPattern& cfa, std::span<const float> weights, int color,
          double x, double y, double saturated = 1e30);

struct Accumulated {
  double sum = 0.0;
  double weight = 0.0;
};

/// What one frame adds to each sample of the reference; `offset` is that of blocks, in blocks.
Grid<Accumulated> burst_addition(const Grid<double>& reference, const Grid<double>& frame,
                                 const Grid<Vec2>& offset, int block, const CfaPattern& cfa,
                                 const BurstLevels& levels);

/// The value that stands for a block in the search.
double block_feature(const Grid<double>& mosaic, int column, int row, int block, const CfaPattern& cfa,
                     const NoiseModel& noise);

}  // namespace becalm::reference
