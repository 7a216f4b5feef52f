#pragma once

#include <deque>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/adaptive_sampling.h"
#include "app/outputs.h"
#include "app/profile.h"
#include "app/progress.h"
#include "frame/frame.h"
#include "frame/io/exr.h"
#include "tracer/render.h"

namespace becalm::app {

/// Files of noisy frames, as float with every layer that the filter reads.
struct NoisyFiles {
  Outputs outputs;
  io::Attributes attributes;  ///< that all of them must have to be read
  std::string preset;         ///< that they are made for, though others may read them
  std::set<int> existing{};   ///< those that --resume found whole: read instead of rendered
};

/// The tracer as a source of frames. Frames are made by one thread at a time; any may read files.
class RenderedFrames {
 public:
  /// With `sampling`, it decides the samples of each pixel. With `files`, every frame that is rendered is
  /// also written there.
  /// A frame has a view for each of `eyes`; `sampling` has as many entries, or none.
  RenderedFrames(tracer::Scene& scene, const tracer::RenderOptions& options, std::vector<Eye> eyes,
                 std::deque<AdaptiveSampling>& sampling, const NoisyFiles* files, Progress& progress,
                 Profile& profile);

  /// Renders the frame or reads the file that is there; nothing if a stop was requested meanwhile.
  std::optional<io::LoadedFrame> make(int frame);
  /// Sees to it that the frame's file is there; false if a stop was requested meanwhile.
  bool make_file(int frame);
  io::LoadedFrame read_file(int frame) const;

 private:
  std::optional<io::LoadedFrame> render(int frame);
  std::optional<Frame> render_eye(int frame, std::size_t eye);

  tracer::Scene& scene_;
  const tracer::RenderOptions options_;
  const std::vector<Eye> eyes_;
  std::deque<AdaptiveSampling>& sampling_;  ///< of each eye
  const NoisyFiles* const files_;
  Progress& progress_;
  Profile& profile_;
  int made_ = 0;  ///< rendered or read, in this run
};

}  // namespace becalm::app
