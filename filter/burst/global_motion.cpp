#include "filter/burst/global_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "filter/for_rows.h"

namespace becalm::filter {
namespace {

constexpr int kUnknowns = 8;
using Vector = std::array<double, kUnknowns>;

/// Normal equations of a weighted least-squares fit.
struct Equations {
  std::array<Vector, kUnknowns> matrix{};
  Vector right{};

  void add(const Vector& row, double value, double w) {
    for (int i = 0; i < kUnknowns; ++i) {
      for (int j = 0; j <= i; ++j) matrix[i][j] += w * row[i] * row[j];
      right[i] += w * row[i] * value;
    }
  }
  Equations& operator+=(const Equations& other) {
    for (int i = 0; i < kUnknowns; ++i) {
      for (int j = 0; j <= i; ++j) matrix[i][j] += other.matrix[i][j];
      right[i] += other.right[i];
    }
    return *this;
  }

  /// By Cholesky's decomposition; what nothing determines is 0.
  Vector solution() const {
    auto l = matrix;
    Vector x = right;
    for (int i = 0; i < kUnknowns; ++i) {
      l[i][i] += 1e-6 * matrix[i][i] + 1e-9;
      for (int j = 0; j <= i; ++j) {
        for (int k = 0; k < j; ++k) l[i][j] -= l[i][k] * l[j][k];
        l[i][j] = i == j ? std::sqrt(std::max(l[i][i], 1e-12)) : l[i][j] / l[j][j];
      }
    }
    for (int i = 0; i < kUnknowns; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= l[i][k] * x[k];
      x[i] /= l[i][i];
    }
    for (int i = kUnknowns; i-- > 0;) {
      for (int k = i + 1; k < kUnknowns; ++k) x[i] -= l[k][i] * x[k];
      x[i] /= l[i][i];
    }
    return x;
  }
};

/// What dx and dy are linear in.
std::pair<Vector, Vector> basis(int x, int y, int width, int height) {
  const double half = 0.5 * std::max(width, height);
  const double u = (x + 0.5 - 0.5 * width) / half;
  const double v = (y + 0.5 - 0.5 * height) / half;
  return {Vector{1, u, v, 0, 0, 0, u * u, u * v}, Vector{0, 0, 0, 1, u, v, u * v, v * v}};
}

double dot(const Vector& a, const Vector& b) {
  double sum = 0.0;
  for (int i = 0; i < kUnknowns; ++i) sum += a[i] * b[i];
  return sum;
}

double bilinear(const Image& image, double x, double y) {
  x = std::clamp(x, 0.0, image.width() - 1.0);
  y = std::clamp(y, 0.0, image.height() - 1.0);
  const int x0 = std::min(static_cast<int>(x), image.width() - 2),
            y0 = std::min(static_cast<int>(y), image.height() - 2);
  const double tx = x - x0, ty = y - y0;
  return (1 - ty) * ((1 - tx) * image.at(x0, y0, 0) + tx * image.at(x0 + 1, y0, 0)) +
         ty * ((1 - tx) * image.at(x0, y0 + 1, 0) + tx * image.at(x0 + 1, y0 + 1, 0));
}

double squared_gradient(const Image& image, int x, int y) {
  const double gx = image.at(x + 1, y, 0) - image.at(x - 1, y, 0);
  const double gy = image.at(x, y + 1, 0) - image.at(x, y - 1, 0);
  return gx * gx + gy * gy;
}

/// Sums `add(equations, x, y)` over every `stride`-th pixel that has neighbours. The order is fixed.
template <class Add>
Equations sum_over(const Image& image, int stride, const Add& add) {
  const int rows = std::max((image.height() - 2) / stride, 0);
  return sum_of_rows<Equations>(rows, [&](int row) {
    Equations sum;
    for (int x = 1; x + 1 < image.width(); x += stride) add(sum, x, 1 + row * stride);
    return sum;
  });
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// About 400,000 pixels suffice for the fit.
int stride_of(const Image& image) {
  constexpr double most = 400'000;
  return std::max(1, static_cast<int>(std::sqrt(static_cast<double>(image.pixel_count()) / most)));
}

/// Noise alone has a squared gradient of 4; less than this tells no offset.
constexpr double kTexture = 12.0;

GlobalMotion of_offsets(const Image& target, const Image& offset, int stride) {
  std::vector<double> dx, dy;
  for (int y = 1; y + 1 < target.height(); y += stride) {
    for (int x = 1; x + 1 < target.width(); x += stride) {
      if (squared_gradient(target, x, y) < kTexture) continue;
      dx.push_back(offset.at(x, y, 0));
      dy.push_back(offset.at(x, y, 1));
    }
  }
  GlobalMotion motion;
  if (dx.empty()) return motion;
  motion.p[0] = median(dx);
  motion.p[3] = median(dy);
  // Cauchy's weights; their width shrinks to that of right offsets.
  double scale = 8.0;
  for (int round = 0; round < 12; ++round, scale = std::max(0.5 * scale, 0.3)) {
    const Equations sum = sum_over(target, stride, [&](Equations& equations, int x, int y) {
      if (squared_gradient(target, x, y) < kTexture) return;
      const auto [bx, by] = basis(x, y, target.width(), target.height());
      const double ex = offset.at(x, y, 0) - dot(bx, motion.p), ey = offset.at(x, y, 1) - dot(by, motion.p);
      const double w = 1.0 / (1.0 + (ex * ex + ey * ey) / (scale * scale));
      equations.add(bx, ex, w);
      equations.add(by, ey, w);
    });
    const Vector step = sum.solution();
    for (int i = 0; i < kUnknowns; ++i) motion.p[i] += step[i];
  }
  return motion;
}

/// One Gauss-Newton step; `scale` is the difference at which a pixel counts for a quarter.
Vector step_of(const Image& target, const Image& source, const GlobalMotion& motion, int stride,
               double scale) {
  return sum_over(
             target, stride,
             [&](Equations& equations, int x, int y) {
               const Imath::V2d at = Imath::V2d(x, y) + motion.offset(x, y, target.width(), target.height());
               if (at.x < 1 || at.y < 1 || at.x > source.width() - 2 || at.y > source.height() - 2) return;
               const double r = target.at(x, y, 0) - bilinear(source, at.x, at.y);
               // The gradients of both, in neither of which the pixel itself has a part: its noise would
               // pull towards no motion.
               const double gx = 0.25 * (bilinear(source, at.x + 1, at.y) - bilinear(source, at.x - 1, at.y) +
                                         target.at(x + 1, y, 0) - target.at(x - 1, y, 0));
               const double gy = 0.25 * (bilinear(source, at.x, at.y + 1) - bilinear(source, at.x, at.y - 1) +
                                         target.at(x, y + 1, 0) - target.at(x, y - 1, 0));
               const auto [bx, by] = basis(x, y, target.width(), target.height());
               Vector row;
               for (int i = 0; i < kUnknowns; ++i) row[i] = gx * bx[i] + gy * by[i];
               const double robust = 1.0 / (1.0 + r * r / (scale * scale));
               equations.add(row, r, robust * robust);
             })
      .solution();
}

double median_difference(const Image& target, const Image& source, const GlobalMotion& motion, int stride) {
  std::vector<double> values;
  for (int y = 1; y + 1 < target.height(); y += 2 * stride) {
    for (int x = 1; x + 1 < target.width(); x += 2 * stride) {
      if (squared_gradient(target, x, y) < kTexture) continue;
      const Imath::V2d at = Imath::V2d(x, y) + motion.offset(x, y, target.width(), target.height());
      values.push_back(std::abs(target.at(x, y, 0) - bilinear(source, at.x, at.y)));
    }
  }
  return values.empty() ? 0.0 : median(values);
}

}  // namespace

Imath::V2d GlobalMotion::offset(int x, int y, int width, int height) const {
  const auto [bx, by] = basis(x, y, width, height);
  return {dot(bx, p), dot(by, p)};
}

GlobalMotion fit_global_motion(const Image& target, const Image& source, const Image& offset) {
  const int stride = stride_of(target);
  GlobalMotion motion = of_offsets(target, offset, stride);
  GlobalMotion best = motion;
  double least = median_difference(target, source, motion, stride);
  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    const Vector step = step_of(target, source, motion, stride, std::max(4.0, 3.0 * least));
    for (int i = 0; i < kUnknowns; ++i) motion.p[i] += step[i];
    const double now = median_difference(target, source, motion, stride);
    if (now > 1.05 * least) break;
    best = motion;
    least = std::min(now, least);
  }
  return best;
}

}  // namespace becalm::filter
