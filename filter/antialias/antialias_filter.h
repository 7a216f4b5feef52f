#pragma once

#include <Imath/ImathBox.h>

#include <memory>
#include <string>

#include "filter/antialias/antialias_settings.h"
#include "filter/gpu/device.h"
#include "filter/sequence/frame_filter.h"

namespace becalm::filter {

/// AOVs that antialiasing uses if frames have them.
AovSet wanted_aovs(const AntialiasSettings& settings);

/// A sentence for the user that names how frames with these AOVs are reprojected.
std::string reprojected_text(const AntialiasSettings& settings, const AovSet& available);

/// Why the device cannot take the frames of this window whole, as this filter needs them; empty if it can.
std::string size_problem(const gpu::Device& device, const AntialiasSettings& settings,
                         const Imath::Box2i& window);

/// Temporal antialiasing of a sequence of few, jittered samples a pixel (Frame::jitter) and little noise. All
/// four channels of the beauty are averaged over time. Non-finite pixels are counted, come out as they came,
/// and take no part in any decision.
class AntialiasFilter : public FrameFilter {
 public:
  /// Builds the chains for this size. Throws gpu::DeviceLimitError if the device cannot hold whole frames, or
  /// not within options.memory_limit. Of the options, `alpha` and `light_groups` are ignored.
  AntialiasFilter(gpu::Device& device, const AntialiasSettings& settings, int width, int height,
                  AovSet available, const SequenceOptions& options = {});
  ~AntialiasFilter() override;
  AntialiasFilter(AntialiasFilter&&) noexcept;

  /// A frame of another size or without an AOV of `available` throws Error(bad_input). Predictions are kept
  /// from the backward step to the forward step of their frame, 12 bytes a pixel each.
  std::optional<Frame> run(const Step& step, const Frame& frame, FrameReport& report) override;
  FilterMemory memory() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
