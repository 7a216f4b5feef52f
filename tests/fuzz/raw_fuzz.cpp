// Feeds bytes to the reader of raw files. Whatever they are, it returns a sound mosaic and sound numbers, or
// throws Error.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "frame/error.h"
#include "frame/raw/raw.h"
#include "tests/scratch_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const becalm::ScratchFolder folder;
  const std::string path = folder.write("frame.dng", data, size);
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  const auto are_finite = [](const auto& values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  try {
    const auto file = becalm::raw::open(path);
    const becalm::raw::Info& info = file->info();
    require(info.width > 0 && info.height > 0);
    require(info.cfa.period == 2 || info.cfa.period == 6);
    require(are_finite(std::array{info.shutter_s, info.iso, info.f_number}));
    require(are_finite(info.white_balance) && std::ranges::min(info.white_balance) > 0.0f);
    require(are_finite(info.camera_to_rec709) && are_finite(info.xyz_to_camera));
    if (info.noise) require(are_finite(std::array{info.noise->a, info.noise->b}));
    const becalm::Mosaic mosaic = becalm::raw::read(*file, path);
    require(mosaic.samples.width() == info.width && mosaic.samples.height() == info.height);
    require(are_finite(mosaic.samples.data()));
  } catch (const becalm::Error&) {
  }
  return 0;
}
