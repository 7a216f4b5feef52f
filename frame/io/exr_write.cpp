#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/format.h>

#include "frame/io/exr_parts.h"
#include "frame/io/jitter_text.h"
#include "frame/io/stereo_text.h"

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
  return write_exr(path, {{"", &frame}}, attributes, color_type);
}

WriteReport write_exr(const std::string& path, const std::vector<WrittenView>& views,
                      const Attributes& attributes, PixelType color_type) {
  const Imf::PixelType color = color_type == PixelType::half ? Imf::HALF : Imf::FLOAT;
  std::vector<Imf::Header> headers;
  std::vector<FrameChannels> channels(views.size());
  for (std::size_t view = 0; view < views.size(); ++view) {
    const Frame& frame = *views[view].frame;
    Imf::Header& header = headers.emplace_back(frame.width(), frame.height());
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    if (!views[view].name.empty()) header.setView(views[view].name);
    if (views.size() > 1) header.setName(views[view].name);
    insert_attributes(header, attributes);
    if (frame.jitter()) insert_attributes(header, {{kJitterAttribute, format_jitter(*frame.jitter())}});
    if (frame.checkerboard()) {
      insert_attributes(header,
                        {{kCheckerboardAttribute, *frame.checkerboard() == Parity::odd ? "odd" : "even"}});
    }
    if (frame.stereo()) insert_attributes(header, {{kStereoAttribute, format_stereo(*frame.stereo())}});
    for (const AovInfo& entry : kAovTable) {
      if (!frame.has(entry.aov)) continue;
      add_layer(frame, entry.aov, "", is_always_float(entry.aov) ? Imf::FLOAT : color, Imath::V2i(0), header,
                channels[view]);
    }
    for (const LightGroup& group : frame.light_groups())
      add_light_group(group, color, header, channels[view]);
  }
  WriteReport report;
  writing(path, headers, [&](Imf::MultiPartOutputFile& file) {
    for (std::size_t view = 0; view < views.size(); ++view)
      write_part(file, static_cast<int>(view), channels[view], nullptr, report);
  });
  return report;
}

void write_plane_exr(const std::string& path, const Image& plane, const Attributes& attributes) {
  Imf::Header header(plane.width(), plane.height());
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  insert_attributes(header, attributes);
  WriteReport report;
  writing(path, {header}, [&](Imf::MultiPartOutputFile& file) {
    write_part(file, 0, {{"Y", {&plane, 0}}}, nullptr, report);
  });
}

}  // namespace becalm::io
