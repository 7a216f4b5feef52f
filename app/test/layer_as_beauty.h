#pragma once

#include <Imath/ImathVec.h>

#include <string>

#include "frame/frame.h"

namespace becalm::app {

/// A frame, where its first pixel lies in the file's coordinates, and how the file rounds.
struct PlacedFrame {
  Frame frame;
  Imath::V2i first;
  /// As LoadedView::rounding has it, of the file's beauty and variance.
  float beauty_rounding = 0.0f;
  float variance_rounding = 0.0f;
};

/// Reads a file for a case that is judged by a layer: the frame's beauty is that layer, of becalm's layers
/// with their channels as R, G and B, 0 where they have fewer and where a pixel hits nothing. `layer` empty:
/// the beauty itself. Throws Error(bad_input) for a layer that is not there.
PlacedFrame read_layer_as_beauty(const std::string& path, int number, const std::string& layer);

}  // namespace becalm::app
