#include "tests/tracer/test_images.h"

#include <OpenImageIO/imageio.h>

#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {

std::string write_image(const std::string& name, int width, int height, int channels,
                        const std::vector<float>& pixels, OIIO::TypeDesc samples) {
  std::string path = file_path(name);
  auto file = OIIO::ImageOutput::create(path);
  file->open(path, OIIO::ImageSpec(width, height, channels, samples));
  file->write_image(OIIO::TypeFloat, pixels.data());
  file->close();
  return path;
}

std::string write_image(const std::string& name, int width, int height, int channels,
                        const std::vector<float>& pixels) {
  return write_image(name, width, height, channels, pixels,
                     name.ends_with(".png") ? OIIO::TypeUInt8 : OIIO::TypeFloat);
}

}  // namespace becalm::tracer::test
