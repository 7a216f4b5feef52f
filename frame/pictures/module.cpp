// The library of pictures.h: whole pictures. Textures: texture_files.cpp.

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>

#include "frame/pictures/pictures.h"
#include "frame/pictures/texture_files.h"

namespace becalm::pictures {
namespace {

class OpenPicture : public Picture {
 public:
  explicit OpenPicture(std::unique_ptr<OIIO::ImageInput> file) : file_(std::move(file)) {
    const OIIO::ImageSpec& spec = file_->spec();
    // Reading anything else would give more than its width times its height.
    if (spec.depth > 1 || spec.deep || spec.width < 1 || spec.height < 1)
      throw std::runtime_error("it is a volume or has deep pixels, expected a flat image");
    header_ = {.width = spec.width,
               .height = spec.height,
               .channels = spec.nchannels,
               .alpha_channel = spec.alpha_channel,
               .float_samples = spec.format.is_floating_point()};
  }

  const Header& header() const override { return header_; }

  void read(std::span<float> pixels) override {
    if (!file_->read_image(0, 0, 0, header_.channels, OIIO::TypeFloat, pixels.data()))
      throw std::runtime_error(file_->geterror());
  }

 private:
  std::unique_ptr<OIIO::ImageInput> file_;
  Header header_;
};

class OpenImageIoLibrary : public Library {
 public:
  std::unique_ptr<Picture> open(const std::string& path, Alpha alpha) override {
    auto file = alpha == Alpha::separate ? open_separate(path) : OIIO::ImageInput::open(path);
    if (!file) throw std::runtime_error(OIIO::geterror());
    return std::make_unique<OpenPicture>(std::move(file));
  }

  std::unique_ptr<TextureFiles> texture_files() override { return make_texture_files(); }

  std::vector<unsigned char> png_bytes(int width, int height, std::span<const std::uint8_t> rgb) override {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create("memory.png");
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("Software", "becalm");
    if (output) output->set_ioproxy(&memory);
    if (!output || !output->open("memory.png", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) || !output->close()) {
      throw std::runtime_error(output ? output->geterror() : OIIO::geterror());
    }
    return bytes;
  }
};

}  // namespace
}  // namespace becalm::pictures

extern "C" becalm::pictures::Library* becalm_pictures_library() {
  static becalm::pictures::OpenImageIoLibrary library;
  return &library;
}
