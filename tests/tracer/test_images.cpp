#include "tests/tracer/test_images.h"

#include <OpenImageIO/imageio.h>

#include "tests/tracer/test_scenes.h"

namespace becalm::tracer::test {

std::string write_image(const std::string& name, int width, int height, int channels,
                        const std::vector<float>& pixels) {
  std::string path = file_path(name);
  auto file = OIIO::ImageOutput::create(path);
  const bool png = name.ends_with(".png");
  file->open(path, OIIO::ImageSpec(width, height, channels, png ? OIIO::TypeUInt8 : OIIO::TypeFloat));
  file->write_image(OIIO::TypeFloat, pixels.data());
  file->close();
  return path;
}

}  // namespace becalm::tracer::test
