#pragma once

#include <string>

#include "tracer/render.h"
#include "tracer/scene/load/load.h"

namespace becalm::tracer::test {

/// A file of that name in a folder of the running test's own. Returns its path.
std::string write_file(const std::string& name, const std::string& text);
/// Writes `uv.ppm`, 4x2 pixels of different colours, none like its mirror image.
void write_uv_picture();
/// The path that write_file would give.
std::string file_path(const std::string& name);

/// JSON with ' in place of ", which reads better in C++.
Scene load_text(const std::string& json);

/// The message of the Error(bad_input) that loading this scene text throws, its folder removed; "no error" if
/// it throws none.
std::string load_error(const std::string& json);

/// {'radius_px': 0, ...}: samples at the pixel centres, so that AOVs can be compared with geometry exactly.
inline const char* const kPointFilter = "'filter': {'type': 'box', 'radius_px': 0}";

RenderOptions options(int spp, std::initializer_list<Aov> aovs = {}, std::uint32_t seed = 0);

/// Mean over the pixels of an image region's channel, and the standard error of it from the variance AOV.
struct Mean {
  double value;
  double error;
};
Mean mean_radiance(const Frame& frame, int channel = 0);
Mean mean_radiance(const Frame& frame, int channel, int x0, int y0, int x1, int y1);

}  // namespace becalm::tracer::test
