#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "app/filter_stage.h"
#include "app/input_check.h"
#include "app/input_frames.h"
#include "frame/io/exr.h"
#include "frame/io/layers.h"

namespace becalm::app {

/// The attribute of outputs that records which layers were denoised.
inline constexpr const char* kLayersAttribute = "becalm:layers";

/// Which channels of a view the filter takes as which AOVs, as that attribute has it:
/// `beauty=R,G,B,A albedo=albedo.R,...`; of a file with parts that have names, `albedo=PART/R,...`.
std::string layers_text(const io::ExrView& view, AovSet used);

/// What outputs were made from, as they record it, so that --resume finds those whose inputs have changed
/// since: of every frame, the size and the bytes of its file and the layers that were taken from it; the
/// frame that the output shows; and the window that the filter saw. Bytes, not decoded channels: an output
/// also holds the channels that are passed on, and bytes cost a tenth of decoding them. May be called from
/// any thread.
class Fingerprints {
 public:
  Fingerprints(const InputFrames& inputs, const FilterStage& filter, const io::LayerOptions& layers,
               const InputWindow& window)
      : inputs_(inputs), filter_(filter), layers_(layers), window_(window) {}

  /// Remembers what the file of a frame holds now; called when its pixels are read.
  void take(int frame);
  /// For the output of a frame: `becalm:inputs`, the frames that it is made from and a hash of them, as
  /// `1-40 0123456789abcdef`; `becalm:layers`, what was taken from the frame's own file; and
  /// `becalm:input_settings` if becalm wrote that. Calls take() for frames that were not taken yet.
  io::Attributes of(int frame);
  /// `beauty=R,G,B,A albedo=...`: what the filter takes of the frame's file.
  std::string layers_of(int frame) { return taken(frame).layers; }
  /// Of `existing` outputs, those all of whose files were made from what is there now.
  std::set<int> up_to_date(const std::set<int>& existing,
                           const std::function<std::vector<std::string>(int)>& paths);

 private:
  struct Taken {
    std::uint64_t hash = 0;
    std::string layers;
    std::string settings;
  };
  const Taken& taken(int frame);
  std::set<int> read_for(int frame) const;

  const InputFrames& inputs_;
  const FilterStage& filter_;
  const io::LayerOptions& layers_;
  const InputWindow& window_;
  std::mutex mutex_;
  std::map<int, Taken> taken_;
};

}  // namespace becalm::app
