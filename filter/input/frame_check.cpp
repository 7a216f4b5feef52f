#include "filter/input/frame_check.h"

#include <fmt/format.h>

#include "frame/error.h"

namespace becalm::filter {

void check_frame(const Frame& frame, int width, int height, const AovSet& required, std::string_view others) {
  if (frame.width() != width || frame.height() != height) {
    throw Error(ExitStatus::bad_input,
                fmt::format("frame {}: size {}x{}: expected {}x{} as {}", frame.number(), frame.width(),
                            frame.height(), width, height, others));
  }
  for (const AovInfo& entry : kAovTable) {
    if (contains(required, entry.aov) && !frame.has(entry.aov)) {
      throw Error(ExitStatus::bad_input, fmt::format("frame {}: no layer '{}', which {} have", frame.number(),
                                                     entry.name.empty() ? "beauty" : entry.name, others));
    }
  }
}

}  // namespace becalm::filter
