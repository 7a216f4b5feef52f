#include "app/rendered_frames.h"

#include <fmt/format.h>

#include <utility>

#include "app/cancel.h"
#include "app/eye_names.h"

namespace becalm::app {

RenderedFrames::RenderedFrames(tracer::Scene& scene, const tracer::RenderOptions& options,
                               std::vector<Eye> eyes, std::deque<AdaptiveSampling>& sampling,
                               const NoisyFiles* files, Progress& progress, Profile& profile)
    : scene_(scene),
      options_(options),
      eyes_(std::move(eyes)),
      sampling_(sampling),
      files_(files),
      progress_(progress),
      profile_(profile) {}

std::optional<io::LoadedFrame> RenderedFrames::make(int frame) {
  progress_.update(frame, made_);
  io::LoadedFrame loaded;
  if (files_ != nullptr && files_->existing.contains(frame)) {
    const ProfileScope scope(profile_, "read");
    loaded = read_file(frame);
  } else {
    std::optional<io::LoadedFrame> noisy = render(frame);
    if (!noisy) return std::nullopt;
    loaded = std::move(*noisy);
  }
  if (stop_requested()) return std::nullopt;
  ++made_;
  return loaded;
}

bool RenderedFrames::make_file(int frame) {
  if (files_->existing.contains(frame)) return true;  // and is no work
  progress_.update(frame, made_);
  if (!render(frame)) return false;
  progress_.update(frame, ++made_);
  return true;
}

io::LoadedFrame RenderedFrames::read_file(int frame) const {
  return io::read_exr(files_->outputs.path(frame), frame, options_.aovs, {},
                      options_.light_groups ? io::LightGroups::read : io::LightGroups::leave);
}

std::optional<io::LoadedFrame> RenderedFrames::render(int frame) {
  io::LoadedFrame made;
  made.other_views.resize(eyes_.size() - 1);
  std::vector<io::WrittenView> views;
  for (std::size_t eye = 0; eye < eyes_.size(); ++eye) {
    std::optional<Frame> noisy = render_eye(frame, eye);
    if (!noisy) return std::nullopt;
    io::LoadedView& view = eye == 0 ? made : made.other_views[eye - 1];
    view.frame = std::move(*noisy);
    view.view = name_of_eye(eyes_[eye]);
    views.push_back({view.view, &view.frame});
  }
  if (files_ != nullptr) {
    const ProfileScope scope(profile_, "write noisy");
    io::Attributes attributes = of_frame(files_->attributes, frame);
    attributes.emplace_back("becalm:preset", files_->preset);
    io::write_exr(files_->outputs.path(frame), views, attributes, io::PixelType::float32);
  }
  return made;
}

std::optional<Frame> RenderedFrames::render_eye(int frame, std::size_t eye) {
  tracer::RenderOptions options = options_;
  options.eye = eyes_[eye];
  options.progress = [this, frame, eye](double share) {
    progress_.update(frame, made_ + (static_cast<double>(eye) + share) / static_cast<double>(eyes_.size()));
  };
  options.cancel = &stop_requested();
  std::optional<Image> counts;
  if (!sampling_.empty()) {
    const ProfileScope scope(profile_, "pilot");
    counts = sampling_[eye].counts(frame);
    if (!counts) return std::nullopt;
    options.sample_counts = &*counts;
  }
  tracer::RenderReport report;
  std::optional<Frame> noisy;
  {
    const ProfileScope scope(profile_, "render");
    noisy = tracer::render_frame(scene_, frame, options, &report);
  }
  progress_.detail(fmt::format(
      "frame {}: {:.3g} samples per pixel", frame,
      static_cast<double>(report.samples) / (static_cast<double>(options.width) * options.height)));
  if (report.non_finite_samples > 0) {
    const tracer::PixelSample first = report.first_non_finite.value_or(tracer::PixelSample{});
    progress_.warn(
        fmt::format("frame {}: {} samples were NaN or Inf and were left out; the first: --frames {} "
                    "{}--debug-pixel {},{},{}",
                    frame, report.non_finite_samples, frame, options.eye == Eye::right ? "--eye right " : "",
                    first.x, first.y, first.sample));
  }
  return noisy;
}

}  // namespace becalm::app
