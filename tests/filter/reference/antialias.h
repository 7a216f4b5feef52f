#pragma once

#include <array>
#include <functional>

#include "filter/antialias/antialias_settings.h"
#include "tests/filter/reference/grid.h"

namespace becalm::reference {

using Rgb = std::array<double, 3>;

/// What antialiasing keeps of a pixel.
struct Antialiased {
  Rgb color{};
  double variance = 0.0;
  double count = 0.0;  ///< effective frames; 0: none
};

/// Pixels of a jittered frame made of the samples of their 3x3 pixels, `weights` as in filter::SampleGrid.
/// The count is 1.
Grid<Antialiased> reconstruct(const Grid<Rgb>& samples, const std::array<double, 10>& weights);

/// The frame of `scale` times the samples' size that samples make which lie `position` from their pixels'
/// centres, under the Blackman-Harris filter of radius 1.5 of its own pixels and, with a share of 0.3, a tent
/// of `wide_radius` sample pixels. `holds` tells which samples exist. The count is the confidence.
Grid<Antialiased> reconstruct_sparse(const Grid<Rgb>& samples, const std::array<double, 2>& position,
                                     double scale, double wide_radius,
                                     const std::function<bool(int x, int y)>& holds);

/// One frame accumulated onto the history at its pixels by `settings`, without masks.
Grid<Antialiased> accumulate(const Grid<Rgb>& samples, const Grid<Antialiased>& frame,
                             const Grid<Antialiased>& history, const filter::AntialiasSettings& settings);

/// The history brought within the bounds of the 3x3 samples around a pixel.
Rgb rectified(const Grid<Rgb>& samples, int x, int y, const Rgb& history,
              const filter::AntialiasSettings& settings);

}  // namespace becalm::reference
