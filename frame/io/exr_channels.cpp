#include "frame/io/exr_channels.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfPartType.h>

#include <bit>
#include <cstdint>

#include "frame/io/exr_file.h"
#include "frame/io/exr_parts.h"
#include "frame/io/stripe.h"

namespace becalm::io {

struct ExrChannels::File {
  explicit File(const std::string& path) : parts(open_exr(path)) {}
  std::unique_ptr<Imf::MultiPartInputFile> parts;
};

ExrChannels::ExrChannels(const std::string& path) : path_(path) {
  stamp_of(path);
  reading(path, [&] {
    file_ = std::make_unique<File>(path);
    for (int i = 0; i < file_->parts->parts(); ++i) {
      const Imf::Header& header = file_->parts->header(i);
      Part& part = parts_.emplace_back(Part{.name = header.hasName() ? header.name() : "",
                                            .data_window = header.dataWindow(),
                                            .display_window = header.displayWindow(),
                                            .channels = {},
                                            .is_deep = header.hasType() && Imf::isDeepData(header.type())});
      if (part.is_deep) continue;
      for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
        part.channels.emplace_back(channel.name());
      }
    }
  });
}

ExrChannels::~ExrChannels() = default;

bool ExrChannels::stores_half(std::size_t part, const std::string& channel) const {
  return file_->parts->header(static_cast<int>(part)).channels().findChannel(channel)->type == Imf::HALF;
}

Image ExrChannels::read(std::size_t part, const std::string& channel) const {
  Image image;
  reading(path_, [&] {
    Imf::InputPart input(*file_->parts, static_cast<int>(part));
    const Imf::Channel& described = *input.header().channels().findChannel(channel);
    const Imath::Box2i window = input.header().dataWindow();
    const int width = (window.max.x - window.min.x) / described.xSampling + 1;
    const int height = (window.max.y - window.min.y) / described.ySampling + 1;
    std::vector<std::uint32_t> words(static_cast<std::size_t>(width) * height);
    const Imf::PixelType type = described.type == Imf::UINT ? Imf::UINT : Imf::FLOAT;
    // Where pixel (0, 0) would be, which a channel's first need not be.
    const auto row = static_cast<std::ptrdiff_t>(width);
    std::uint32_t* const origin =
        words.data() - window.min.y / described.ySampling * row - window.min.x / described.xSampling;
    Imf::FrameBuffer pixels;
    pixels.insert(channel, Imf::Slice(type, reinterpret_cast<char*>(origin), sizeof(words[0]),
                                      sizeof(words[0]) * width, described.xSampling, described.ySampling));
    input.setFrameBuffer(pixels);
    input.readPixels(window.min.y, window.max.y);
    image = Image(width, height, type == Imf::UINT ? 2 : 1);
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (type == Imf::UINT) {
        image.data()[2 * i] = static_cast<float>(words[i] >> 16);
        image.data()[2 * i + 1] = static_cast<float>(words[i] & 0xffffu);
      } else {
        image.data()[i] = std::bit_cast<float>(words[i]);
      }
    }
  });
  return image;
}

void require_whole_exr(const std::string& path) {
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    require_all_chunks(path, *file);
    for (int number = 0; number < file->parts(); ++number) {
      const Imf::Header& header = file->header(number);
      const auto channel = header.channels().begin();
      if (is_deep(header) || channel == header.channels().end()) continue;
      // A chunk has all channels of its lines, so that one of them tells of all.
      Stripe stripe(header.dataWindow());
      stripe.add(channel.name(), channel.channel().type, channel.channel().xSampling,
                 channel.channel().ySampling);
      Imf::InputPart part(*file, number);
      const ReadLines read = lines_of(part);
      for_each_stripe(header, [&](int first, int last) {
        stripe.move_to(first, last);
        read(stripe, [](const Stripe::Plane&) { return true; });
      });
    }
  });
}

}  // namespace becalm::io
