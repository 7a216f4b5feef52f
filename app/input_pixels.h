#pragma once

#include "app/filter_stage.h"
#include "app/input_check.h"
#include "app/input_frames.h"
#include "frame/io/exr.h"
#include "frame/io/layers.h"

namespace becalm::app {

/// Reads a frame that is denoised, as far as the filter wants it: one file, or two with a half of the samples
/// each, which are joined, or of the two eyes. Every frame covers `window`. Throws as io::read_exr and
/// join_halves do.
io::LoadedFrame read_pixels(const InputFrames& inputs, int frame, const FilterStage& filter,
                            const io::LayerOptions& layers, const InputWindow& window,
                            io::KeepPassedOn keep = io::KeepPassedOn::no);

}  // namespace becalm::app
