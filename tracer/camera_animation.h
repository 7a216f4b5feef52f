#pragma once

#include "tracer/camera.h"
#include "tracer/scene/scene_description.h"

namespace becalm::tracer {

/// The camera at that moment, in frames.
Camera camera_at(const CameraSettings& settings, double frame, int width, int height, Eye eye = Eye::centre);
/// Both eyes at that moment; nothing if the camera has one.
std::optional<StereoCamera> stereo_camera_at(const CameraSettings& settings, double frame, int width,
                                             int height);

/// The cameras of a frame and of the one before, at any time that the shutter is open.
class CameraAnimation {
 public:
  CameraAnimation(const CameraSettings& settings, int frame, int width, int height, Eye eye)
      : settings_(&settings),
        frame_(frame),
        width_(width),
        height_(height),
        eye_(eye),
        moves_(settings.shutter.blurs() && settings.moves()),
        current_(at_frame(frame, 0.0f)),
        previous_(at_frame(frame - 1, 0.0f)) {}

  /// When the shutter opens, and all the time if the camera does not move.
  const Camera& current() const { return current_; }
  const Camera& previous() const { return previous_; }

  bool moves() const { return moves_; }
  Camera current(float time) const { return moves_ ? at_frame(frame_, time) : current_; }
  Camera previous(float time) const { return moves_ ? at_frame(frame_ - 1, time) : previous_; }

 private:
  Camera at_frame(int frame, float time) const {
    return camera_at(*settings_, settings_->shutter.at(frame, static_cast<double>(time)), width_, height_,
                     eye_);
  }

  const CameraSettings* settings_;
  int frame_, width_, height_;
  Eye eye_;
  bool moves_;
  Camera current_, previous_;
};

}  // namespace becalm::tracer
