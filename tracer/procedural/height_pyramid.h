#pragma once

#include <cstddef>
#include <vector>

namespace becalm::tracer {

/// Least and greatest height of a cell.
struct HeightRange {
  float low, high;
};

/// Height ranges of square cells, halved in number along each side from level to level: level 0 has
/// `resolution` cells a side, the last level one. Levels below `first_level` are not stored: rays visit
/// all of their cells.
class HeightPyramid {
 public:
  /// `resolution` is a power of two and at least 2^first_level.
  void resize(int resolution, int first_level);

  int resolution() const { return resolution_; }
  int first_level() const { return first_level_; }
  int last_level() const { return last_level_; }
  int resolution(int level) const { return resolution_ >> level; }

  HeightRange& at(int level, int i, int j) { return ranges_[index(level, i, j)]; }
  const HeightRange& at(int level, int i, int j) const { return ranges_[index(level, i, j)]; }
  const HeightRange& all() const { return ranges_.back(); }

  /// Makes all levels above the first from it.
  void reduce();

  std::size_t bytes() const { return ranges_.capacity() * sizeof(HeightRange); }

 private:
  std::size_t index(int level, int i, int j) const {
    return starts_[static_cast<std::size_t>(level - first_level_)] +
           static_cast<std::size_t>(j) * static_cast<std::size_t>(resolution(level)) +
           static_cast<std::size_t>(i);
  }

  int resolution_ = 0, first_level_ = 0, last_level_ = 0;
  std::vector<std::size_t> starts_;
  std::vector<HeightRange> ranges_;
};

}  // namespace becalm::tracer
