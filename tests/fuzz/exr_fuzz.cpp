// Feeds bytes to everything that reads an EXR file, and writes what loads again. Bad input must only ever
// throw Error.
#include <algorithm>
#include <string>

#include "frame/error.h"
#include "frame/io/additive_layers.h"
#include "frame/io/exr.h"
#include "tests/scratch_folder.h"

namespace {

using namespace becalm;

/// Larger windows are allowed and only cost time and memory here.
constexpr int kMostPixels = 1 << 12;

bool is_small(const Imath::Box2i& window) {
  const auto size = [](int min, int max) { return static_cast<double>(max) - min + 1.0; };
  return size(window.min.x, window.max.x) * size(window.min.y, window.max.y) <= kMostPixels;
}

void read_and_write(const std::string& path, const std::string& out) {
  io::describe_exr(path);
  const auto views = io::read_exr_header(path, {}, io::CheckChunks::yes);
  if (!std::ranges::all_of(views, [](const io::ExrView& view) { return is_small(view.data_window); })) return;
  io::read_attribute(path, "becalm:settings");
  io::find_additive_sets(path, {});
  const io::LoadedFrame loaded = io::read_exr(path, 1, AovSet().set(), {}, io::LightGroups::read);
  std::vector<Frame> others;
  for (const io::LoadedView& view : loaded.other_views) others.push_back(view.frame);
  io::write_denoised_exr(out, loaded.frame, others, loaded, {{"becalm:preset", "final"}});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const becalm::ScratchFolder folder;
  const std::string path = folder.write("in.exr", data, size);
  try {
    read_and_write(path, path + ".out.exr");
  } catch (const Error&) {  // what bad input must do
  }
  return 0;
}
