#include "app/input_pixels.h"

#include <fmt/format.h>

#include <memory>

#include "app/eye_names.h"
#include "app/half_buffers.h"
#include "filter/merge/additive.h"
#include "frame/error.h"

namespace becalm::app {
namespace {

/// Finds eyes that were exchanged, where the files say which they are.
void check_eye(const Frame& frame, Eye eye, const std::string& path) {
  if (!frame.stereo() || frame.stereo()->eye == eye) return;
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: is of the {} eye, as it says itself, and stands for the {} one", path,
                          name_of_eye(frame.stereo()->eye), name_of_eye(eye)));
}

/// Headers have been checked: what is wrong now is damage within pixels, which show it when they are read.
io::LoadedFrame read_file(const InputFrames& inputs, const std::string& path, int frame,
                          const FilterStage& filter, const io::LayerOptions& layers,
                          const InputWindow& window, io::KeepPassedOn keep) {
  const bool additive = filter.denoises_additive();
  const AovSet wanted = additive ? filter.wanted() | filter::additive_aovs() : filter.wanted();
  try {
    return io::read_exr(path, frame, wanted, layers,
                        additive ? io::LightGroups::read : io::LightGroups::leave, window.window, keep);
  } catch (const Error& error) {
    if (error.status() != ExitStatus::bad_input || !inputs.pattern().has_frame_field()) throw;
    throw Error(
        error.status(),
        fmt::format("{}; move the file away, and --missing hold or skip with --resume goes on without",
                    error.what()));
  }
}

}  // namespace

io::LoadedFrame read_pixels(const InputFrames& inputs, int frame, const FilterStage& filter,
                            const io::LayerOptions& layers, const InputWindow& window,
                            io::KeepPassedOn keep) {
  io::LoadedFrame loaded = read_file(inputs, inputs.path(frame), frame, filter, layers, window, keep);
  if (inputs.other_half()) {
    const std::string other = inputs.other_half()->path(frame);
    join_halves(loaded, read_file(inputs, other, frame, filter, layers, window, io::KeepPassedOn::no), other);
  }
  if (inputs.other_eye()) {
    const std::string other = inputs.other_eye()->path(frame);
    loaded.other_eye =
        std::make_shared<io::LoadedFrame>(read_file(inputs, other, frame, filter, layers, window, keep));
    check_eye(loaded.frame, Eye::left, inputs.path(frame));
    check_eye(loaded.other_eye->frame, Eye::right, other);
  }
  return loaded;
}

}  // namespace becalm::app
