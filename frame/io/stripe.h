#pragma once

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>

#include <functional>
#include <string>
#include <vector>

#include "frame/pixel_memory.h"

namespace becalm::io {

/// Some channels of a run of whole lines, as planes of the file's own types. Parts are read and written
/// stripe by stripe, so that a part with many channels never lies in memory whole.
class Stripe {
 public:
  struct Plane {
    std::string channel;
    Imf::PixelType type;
    int x_sampling = 1;
    int y_sampling = 1;
    std::vector<char, PixelAllocator<char>> bytes;
  };

  /// `window` is the part's data window.
  explicit Stripe(const Imath::Box2i& window) : lines_(window) {}

  void add(std::string channel, Imf::PixelType type, int x_sampling = 1, int y_sampling = 1);
  /// Makes room for the lines first..last. The planes then hold anything, and are to be filled.
  void move_to(int first, int last);

  /// The lines in the planes, from the data window's left to its right.
  const Imath::Box2i& lines() const { return lines_; }
  std::vector<Plane>& planes() { return planes_; }
  const std::vector<Plane>& planes() const { return planes_; }
  /// The plane of a channel, or null.
  const Plane* plane_of(const std::string& channel) const;
  /// Bytes of a line of samples.
  std::size_t row_bytes(const Plane& plane) const;
  /// Copies its lines of a channel from another stripe, which holds them in the same type and sampling.
  void copy_lines(const Stripe& from, Plane& plane) const;
  /// Where OpenEXR finds the planes for which `wanted` is true. Valid until the next add() or move_to().
  Imf::FrameBuffer frame_buffer(const std::function<bool(const Plane&)>& wanted) const;

 private:
  Imath::Box2i lines_;
  std::vector<Plane> planes_;
};

/// Bytes of a sample.
std::size_t size_of(Imf::PixelType type);

/// Calls `work(first, last)` for runs of lines that cover the data window, in the file's line order, so that
/// each holds whole chunks or whole rows of tiles.
void for_each_stripe(const Imf::Header& header, const std::function<void(int first, int last)>& work);

}  // namespace becalm::io
