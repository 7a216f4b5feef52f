#include "app/filter_step.h"

#include <fmt/format.h>

#include <utility>

#include "filter/guides.h"

namespace becalm::app {

FilterStep::FilterStep(const std::string& preset, const FilterOptions& options)
    : settings_(resolve_settings(preset, options)),
      diagnostics_(diagnostics_of(options)),
      device_options_(device_options(options)),
      memory_limit_(memory_limit(options)) {}

std::string FilterStep::describe(int first_frame) const {
  return fmt::format("{} diagnostics={} first_frame={}", filter::to_string(settings_),
                     diagnostics_.any() ? "yes" : "no", first_frame);
}

void FilterStep::build(int width, int height, AovSet available) {
  device_.emplace(device_options_);
  filter_.emplace(*device_, settings_, width, height, available, diagnostics_, memory_limit_);
  matched_ = filter::matched_text(settings_, available);
}

filter::Denoised FilterStep::denoise(const Frame& frame, Progress& progress, Profile& profile) {
  std::optional<filter::Denoised> denoised;
  {
    const ProfileScope scope(profile, "filter");
    denoised = filter_->denoise(frame);
  }
  if (!matched_.empty()) progress.note(std::exchange(matched_, {}));
  const filter::FrameReport& report = denoised->report;
  profile.add(report.passes);
  if (report.non_finite_pixels > 0) {
    progress.warn(fmt::format("frame {}: {} pixels with NaN or Inf stay as they came", frame.number(),
                              report.non_finite_pixels));
  }
  if (report.replaced_variances > 0) {
    progress.warn(
        fmt::format("frame {}: {} variances that are negative or not finite were taken as pure noise",
                    frame.number(), report.replaced_variances));
  }
  return std::move(*denoised);
}

void FilterStep::finish(Profile& profile) const {
  if (!filter_) return;
  profile.set_device(device_->info().name, filter_->memory());
  check_validation(*device_);
}

}  // namespace becalm::app
