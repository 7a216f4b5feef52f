#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/options.h"
#include "app/profile.h"
#include "app/progress.h"
#include "filter/gpu/device.h"
#include "filter/order.h"
#include "frame/frame.h"

namespace becalm::app {

/// The filter as `denoise` and `render --denoise` both run it: opens the device, builds the chain once, and
/// reports what happened to each frame.
class FilterStep {
 public:
  /// Throws Error(usage) for a preset or setting that does not exist, and a size that is none.
  FilterStep(const std::string& preset, const FilterOptions& options);

  AovSet wanted() const { return filter::wanted_aovs(settings_); }
  AovSet diagnostics() const { return diagnostics_; }
  /// The settings as the files record them: equal text means that the filter does the same to a frame. Its
  /// history begins at the first frame, which therefore is part of it.
  std::string describe(int first_frame) const;

  /// Opens the device and builds the chain; called before the first frame.
  void build(int width, int height, AovSet available);
  filter::Denoised denoise(const Frame& frame, Progress& progress, Profile& profile);
  void reset() { filter_->reset(); }
  /// Throws DeviceError if the validation layer complained; tells the profile about the device.
  void finish(Profile& profile) const;

 private:
  filter::Settings settings_;
  AovSet diagnostics_;
  gpu::DeviceOptions device_options_;
  std::uint64_t memory_limit_;
  std::optional<gpu::Device> device_;
  std::optional<filter::ForwardFilter> filter_;
  std::string matched_;  ///< what frames are matched by, until it has been said
};

}  // namespace becalm::app
