#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frame/frame.h"
#include "frame/io/layers.h"

namespace becalm::io {

/// All that a file held, kept so that what was not denoised is written again bit for bit. Opaque outside exr.cpp.
class ExrContents;

struct LoadedFrame {
  Frame frame;
  LayerMap layers;
  std::shared_ptr<const ExrContents> contents;
};

/// Text attributes written as `becalm:*`, such as {"becalm:preset", "final"}.
using Attributes = std::vector<std::pair<std::string, std::string>>;

enum class PixelType { half, float32 };

/// Reads one EXR file: the AOVs of `wanted` that it holds (the beauty always), and everything else as contents. The
/// Frame covers the data window. Throws Error(bad_input) naming the file for: no such file, not an EXR, truncated
/// or corrupt pixels, no colour, a deep file.
LoadedFrame read_exr(const std::string& path, int frame_number, AovSet wanted, const LayerOverrides& overrides = {});

/// Layers and parts without reading pixels, for `becalm info`: one line of text each.
std::vector<std::string> describe_exr(const std::string& path, const LayerOverrides& overrides = {});

/// The value of a text attribute of the first part, or empty. Throws as read_exr does.
std::string read_attribute(const std::string& path, const std::string& name);

struct WriteReport {
  std::size_t half_overflows = 0;  ///< finite values beyond half's range, written as its largest value
};

/// Writes every AOV of the frame as a layer of a single-part scanline file with ZIP compression: beauty and other
/// colours as `color_type`, depth, motion and diagnostics as float. Written beside its place and renamed, so that a
/// killed run leaves whole files only; the parent folder is made. Throws Error(resource) naming the path.
WriteReport write_exr(const std::string& path, const Frame& frame, const Attributes& attributes,
                      PixelType color_type = PixelType::half);

/// Writes `source` again with the beauty's channels replaced by the frame's, in the same parts, types, compression,
/// windows and attributes, every other channel bit for bit; diagnostics of the frame are added as layers to the
/// beauty's part. Atomic as write_exr is.
WriteReport write_denoised_exr(const std::string& path, const Frame& frame, const ExrContents& source,
                               const LayerMap& layers, const Attributes& attributes);

}  // namespace becalm::io
