#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// An image in memory with its MIP levels, looked up without locks: what a path tracer asks for several times
/// a sample. Texels are 16-bit steps between the image's least and largest number, so that nothing is further
/// off than 1/131070 of that range.
class MipTexture {
 public:
  /// Longest over shortest side of what a lookup averages, and the number of its probes.
  static constexpr int kAnisotropy = 4;

  /// `texels` are finite, rows from the top, 1 or 3 channels.
  MipTexture(int width, int height, int channels, const std::vector<float>& texels);

  /// Memory that a texture of that size takes.
  static std::size_t bytes(int width, int height, int channels);

  /// Averages about the parallelogram of the two derivatives around (s, t): trilinear probes along its longer
  /// side. (0,0) is the top left corner; s and t in [0,1], outside of which the picture repeats. Writes as
  /// many values as there are channels.
  void read(const V2f& st, const V2f& dst_dx, const V2f& dst_dy, float* values) const;

 private:
  struct Level {
    int width, height;
    std::size_t first;  ///< texel
  };
  /// Three channels take four, so that a texel is one load.
  using Texel1 = float;
  using Texel4 = float __attribute__((vector_size(16)));

  void add_level(int width, int height, const std::vector<float>& texels);
  void get(std::size_t number, Texel1& texel) const;
  void get(std::size_t number, Texel4& texel) const;
  // What they look up, in steps.
  template <class Texel>
  void at_level(std::size_t level, const V2f& st, Texel& value) const;
  template <class Texel>
  void trilinear(float lod, const V2f& st, Texel& value) const;
  template <class Texel>
  void probes(const V2f& st, const V2f& dst_dx, const V2f& dst_dy, Texel& value) const;

  int channels_;
  float least_ = 0.0f;
  float step_ = 0.0f;
  std::vector<Level> levels_;
  std::vector<std::uint16_t> steps_;
};

}  // namespace becalm::tracer
