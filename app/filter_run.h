#pragma once

#include <functional>
#include <span>

#include "app/filter_step.h"
#include "app/profile.h"
#include "app/progress.h"
#include "filter/sequence/schedule.h"
#include "frame/frame.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// A denoised frame on its way to its files, and what it was made from.
struct DenoisedFile {
  Frame frame;
  std::vector<Frame> other_views;  ///< of a stereo file, in the order of the source's
  io::LoadedFrame source;
};

/// Between the filter and the files.
struct FilterFiles {
  std::function<io::LoadedFrame(int frame)> read;  ///< on a thread of its own
  std::function<void(DenoisedFile&)> write;        ///< on a thread of its own
};

/// Takes frames through the filter in the order of the steps, until a stop is requested: the next one is read
/// and the last one written while the device works. `on_step` is told before each step how many were taken.
void run_filter(FilterStep& filter, std::span<const filter::Step> steps, const FilterFiles& files,
                const std::function<void(std::size_t step)>& on_step, Progress& progress, Profile& profile);

}  // namespace becalm::app
