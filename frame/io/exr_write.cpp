#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/format.h>

#include "frame/io/exr_parts.h"
#include "frame/io/jitter_text.h"

namespace becalm::io {
namespace {

/// Adds a light group's radiance as the layer light.NAME.
void add_light_group(const LightGroup& group, Imf::PixelType type, Imf::Header& header,
                     FrameChannels& channels) {
  for (int c = 0; c < 3; ++c) {
    const std::string name = fmt::format("light.{}.{}", group.name, "RGB"[c]);
    header.channels().insert(name, Imf::Channel(type));
    channels[name] = {&group.radiance, c};
  }
}

bool is_always_float(Aov aov) {
  switch (aov) {
    case Aov::variance:
    case Aov::depth:
    case Aov::motion:
    case Aov::object_id:  // half counts to 2048 only
    case Aov::material_id:
      return true;
    default:
      return info(aov).diagnostic;
  }
}

}  // namespace

WriteReport write_exr(const std::string& path, const Frame& frame, const Attributes& attributes,
                      PixelType color_type) {
  Imf::Header header(frame.width(), frame.height());
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  insert_attributes(header, attributes);
  if (frame.jitter()) insert_attributes(header, {{kJitterAttribute, format_jitter(*frame.jitter())}});
  if (frame.checkerboard()) {
    insert_attributes(header,
                      {{kCheckerboardAttribute, *frame.checkerboard() == Parity::odd ? "odd" : "even"}});
  }
  const Imf::PixelType color = color_type == PixelType::half ? Imf::HALF : Imf::FLOAT;
  FrameChannels channels;
  for (const AovInfo& entry : kAovTable) {
    if (!frame.has(entry.aov)) continue;
    add_layer(frame, entry.aov, "", is_always_float(entry.aov) ? Imf::FLOAT : color, Imath::V2i(0), header,
              channels);
  }
  for (const LightGroup& group : frame.light_groups()) add_light_group(group, color, header, channels);
  WriteReport report;
  writing(path, {header},
          [&](Imf::MultiPartOutputFile& file) { write_part(file, 0, channels, nullptr, report); });
  return report;
}

}  // namespace becalm::io
