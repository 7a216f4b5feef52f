#pragma once

namespace becalm::tracer {

/// When light is collected for a frame, in frames relative to its number. Closed (a moment) by default.
struct Shutter {
  double open = 0.0;
  double close = 0.0;

  bool blurs() const { return close > open; }
  /// `time` in [0,1] runs from the opening to the closing.
  double at(double frame, double time) const { return frame + open + time * (close - open); }
};

}  // namespace becalm::tracer
