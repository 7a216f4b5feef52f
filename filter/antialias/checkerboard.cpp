#include "filter/antialias/checkerboard.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "frame/error.h"

namespace becalm::filter {

void fill_holes(Frame& frame, Parity parity) {
  const Image depth = frame.image(Aov::depth);
  const auto neighbour = [&](int x, int y) {
    Imath::V2i found(x, y);
    float least = std::numeric_limits<float>::infinity();
    for (const Imath::V2i& step : {Imath::V2i(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      const Imath::V2i q = Imath::V2i(x, y) + step;
      if (q.x < 0 || q.y < 0 || q.x >= frame.width() || q.y >= frame.height()) continue;
      const float told = depth.empty() ? 1.0f : depth.at(q.x, q.y, 0);
      const float z = told > 0.0f ? told : std::numeric_limits<float>::infinity();
      if (found != Imath::V2i(x, y) && !(z < least)) continue;
      found = q;
      least = z;
    }
    return found;
  };
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      if (has_sample(parity, x, y)) continue;
      const Imath::V2i from = neighbour(x, y);
      for (const AovInfo& entry : kAovTable) {
        if (entry.aov == Aov::beauty || !frame.has(entry.aov)) continue;
        Image& image = frame.image(entry.aov);
        std::ranges::copy(image.pixel(from.x, from.y), image.pixel(x, y).begin());
      }
    }
  }
}

void require_checkerboard(const Frame& frame) {
  if (frame.checkerboard()) return;
  throw Error(ExitStatus::bad_input,
              fmt::format("frame {}: does not tell which pixels of a checkerboard it holds, as "
                          "becalm:checkerboard would: expected --checkerboard=even or odd",
                          frame.number()));
}

namespace {

void mark_holes(Parity parity, int width, std::uint8_t mark, std::vector<std::uint8_t>& counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const int x = static_cast<int>(i % width);
    const int y = static_cast<int>(i / width);
    if (!has_sample(parity, x, y)) counts[i] = mark;
  }
}

}  // namespace

void leave_holes(Parity parity, int width, std::vector<std::uint8_t>& counts) {
  mark_holes(parity, width, 0, counts);
}

void close_holes(Parity parity, int width, std::vector<std::uint8_t>& counts) {
  mark_holes(parity, width, 1, counts);
}

}  // namespace becalm::filter
