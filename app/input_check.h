#pragma once

#include <Imath/ImathBox.h>

#include <set>
#include <string>
#include <vector>

#include "app/filter_stage.h"
#include "app/input_frames.h"
#include "frame/aov.h"
#include "frame/io/exr.h"
#include "frame/io/layers.h"

namespace becalm::app {

/// What all frames of a sequence have in common, and the filter is built for; of a stereo sequence, one of
/// its views.
struct InputLayout {
  std::string view;  ///< empty where there is but one
  Imath::Box2i display_window;
  AovSet aovs;                            ///< of those that the filter uses
  std::vector<std::string> light_groups;  ///< that it denoises

  bool operator==(const InputLayout&) const = default;
};

/// What the filter takes of a view with this header.
InputLayout layout_of(const io::ExrView& header, const FilterStage& filter);

/// The window that the filter sees of every frame: the data window if all frames have the same. If they
/// differ, since the renderer crops empty margins, it covers the display window and the data windows of all
/// frames that may be read, so that it does not depend on which frames a job writes.
struct InputWindow {
  Imath::Box2i window;
  int width() const { return window.max.x - window.min.x + 1; }
  int height() const { return window.max.y - window.min.y + 1; }
};

/// Of all views of these files, in parallel; those whose headers cannot be read do not count. Throws
/// Error(bad_input) naming the file that makes it larger than any image may be.
InputWindow find_window(const std::vector<std::string>& paths, const io::LayerOptions& layers);
/// Of all frames that may be read.
InputWindow find_window(const InputFrames& inputs, const io::LayerOptions& layers);

/// Reads the headers of `frames`, in parallel, before any pixel is read. Throws Error(bad_input) as
/// FrameProblems does unless every file is there, whole, of the layout that most frames have, and can be
/// written in that format. Returns the views of that layout.
std::vector<InputLayout> check_inputs(const InputFrames& inputs, const std::set<int>& frames,
                                      const FilterStage& filter, const io::LayerOptions& layers,
                                      const io::DenoisedFormat& format);

}  // namespace becalm::app
