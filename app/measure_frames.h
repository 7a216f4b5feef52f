#pragma once

#include <functional>
#include <vector>

#include "app/frame_figures.h"

namespace becalm::app {

struct MeasuredFrame {
  FrameFigures figures;
  const ComparedFrame& images;
};

/// Measures frames side by side, as many as there are threads and as have images of 2 GB together, until a
/// signal asks to stop. `read` and `done` are called for one frame at a time, in the order of `frames`; what
/// `read` throws comes after the frames before it are done. `step` lies between the numbers of frames that
/// follow each other.
void measure_frames(const std::vector<int>& frames, int step, const std::function<ComparedFrame(int)>& read,
                    const std::function<void(const MeasuredFrame&)>& done);

}  // namespace becalm::app
