#include "scripts/benches/raw_image.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>

#include "frame/error.h"

namespace becalm::bench {

Image read_raw(const std::string& path, gpu::Extent extent) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw Error(ExitStatus::bad_input, fmt::format("{}: cannot be read", path));
  const auto bytes = static_cast<std::uint64_t>(file.tellg());
  const std::uint64_t plane = extent.elements() * sizeof(float);
  if (bytes == 0 || bytes % plane != 0 || bytes / plane > 4) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: {} bytes: expected {} times 1 to 4 channels", path, bytes, plane));
  }
  Image image(extent.width, extent.height, static_cast<int>(bytes / plane));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(image.data().data()), static_cast<std::streamsize>(bytes));
  return image;
}

void write_raw(const std::string& path, const Image& image) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(image.data().data()),
             static_cast<std::streamsize>(image.data().size_bytes()));
  if (!file.flush()) throw Error(ExitStatus::resource, fmt::format("{}: cannot be written", path));
}

}  // namespace becalm::bench
