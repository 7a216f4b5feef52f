#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace becalm::reference {

struct Vec2 {
  double x = 0.0;
  double y = 0.0;
};

/// An image of any type, row-major, read with clamped coordinates.
template <class T>
struct Grid {
  int width = 0;
  int height = 0;
  std::vector<T> data;

  Grid() = default;
  Grid(int w, int h, T fill = T{}) : width(w), height(h), data(static_cast<std::size_t>(w) * h, fill) {}
  T& at(int x, int y) { return data[static_cast<std::size_t>(y) * width + x]; }
  const T& at(int x, int y) const { return data[static_cast<std::size_t>(y) * width + x]; }
  const T& clamped(int x, int y) const {
    return at(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1));
  }
};

/// Bilinear value at a position where pixel (x, y) has its centre at (x, y).
inline double bilinear(const Grid<double>& grid, double x, double y) {
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const double tx = x - x0;
  const double ty = y - y0;
  return (1 - ty) * ((1 - tx) * grid.clamped(x0, y0) + tx * grid.clamped(x0 + 1, y0)) +
         ty * ((1 - tx) * grid.clamped(x0, y0 + 1) + tx * grid.clamped(x0 + 1, y0 + 1));
}

}  // namespace becalm::reference
