#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <OpenEXR/ImfDeepTiledOutputPart.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <map>

#include "frame/error.h"
#include "frame/io/atomic_file.h"
#include "frame/io/exr_file.h"
#include "frame/io/stripe.h"

namespace becalm::io {
namespace {

/// OpenEXR's view of an AtomicFile. OpenEXR writes its offset tables in destructors, which swallow
/// exceptions; the file remembers them until it is committed.
class AtomicStream : public Imf::OStream {
 public:
  explicit AtomicStream(const std::string& path) : OStream(path.c_str()), file_(path) {}

  void write(const char* bytes, int size) override { file_.write(bytes, static_cast<std::size_t>(size)); }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
};

/// One channel of the frame on its way into a file, under the file's name for it.
struct FrameChannel {
  const Image* image;
  int channel;
};

using FrameChannels = std::map<std::string, FrameChannel>;

template <class T>
void store(char* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

Imath::half to_half(float value, std::size_t& overflows) {
  if (std::isfinite(value) && std::abs(value) > HALF_MAX) {
    ++overflows;
    value = std::copysign(HALF_MAX, value);
  }
  return Imath::half(value);
}

std::uint32_t to_uint(float value) {
  constexpr double largest = 4294967295.0;
  return std::isnan(value) ? 0u
                           : static_cast<std::uint32_t>(std::clamp<double>(std::round(value), 0.0, largest));
}

/// Converts a window of the file, whose frame begins at `frame_origin`, to the plane's type.
void convert(const FrameChannel& from, const Imath::V2i& frame_origin, const Imath::Box2i& window,
             Stripe::Plane& plane, WriteReport& report) {
  char* to = plane.bytes.data();
  for (int y = window.min.y; y <= window.max.y; ++y) {
    for (int x = window.min.x; x <= window.max.x; ++x) {
      const float value = from.image->at(x - frame_origin.x, y - frame_origin.y, from.channel);
      switch (plane.type) {
        case Imf::HALF:
          store(to, to_half(value, report.half_overflows).bits());
          to += 2;
          break;
        case Imf::UINT:
          store(to, to_uint(value));
          to += 4;
          break;
        default:
          store(to, value);
          to += 4;
      }
    }
  }
}

/// The names of OpenEXR's methods, in the order of its enumeration.
constexpr std::string_view kCompressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                              "pxr24", "b44", "b44a", "dwaa", "dwab"};
static_assert(std::size(kCompressions) == Imf::NUM_COMPRESSION_METHODS);

/// Whether compressing pixels that came out of this method once more could alter them. PXR24 drops bits that
/// are already zero; B44 and the cosine transform of DWA (which it applies by channel name) do not repeat
/// themselves.
bool may_alter(Imf::Compression compression, std::string_view channel, Imf::PixelType type) {
  if (compression == Imf::B44_COMPRESSION || compression == Imf::B44A_COMPRESSION) return type == Imf::HALF;
  if (compression != Imf::DWAA_COMPRESSION && compression != Imf::DWAB_COMPRESSION) return false;
  std::string letter(channel.substr(channel.rfind('.') + 1));
  std::transform(letter.begin(), letter.end(), letter.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static constexpr std::string_view transformed[] = {"r", "g", "b", "y", "by", "ry", "red", "green", "blue"};
  return type != Imf::UINT &&
         std::find(std::begin(transformed), std::end(transformed), letter) != std::end(transformed);
}

void insert_attributes(Imf::Header& header, const Attributes& attributes) {
  for (const auto& [name, value] : attributes) {
    // OpenEXR refuses to change an attribute's type. Its erase() leaks, so it is called only where it must
    // be.
    const bool is_there = header.find(name) != header.end();
    if (is_there && header.findTypedAttribute<Imf::StringAttribute>(name) == nullptr) header.erase(name);
    header.insert(name, Imf::StringAttribute(value));
  }
}

/// Writes the pixels of one part: the channels that `from_frame` names, of a frame that begins at
/// `frame_origin`, and all others from `source`, which may be null if there are none.
void write_part(Imf::MultiPartOutputFile& file, int part, const FrameChannels& from_frame,
                const Imath::V2i& frame_origin, Imf::InputPart* source, WriteReport& report) {
  const Imf::Header& header = file.header(part);
  const Imath::Box2i& window = header.dataWindow();
  Stripe stripe(window);
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    stripe.add(it.name(), it.channel().type, it.channel().xSampling, it.channel().ySampling);
  }
  const auto is_frames = [&](const Stripe::Plane& plane) { return from_frame.contains(plane.channel); };
  const bool all_frames = std::all_of(stripe.planes().begin(), stripe.planes().end(), is_frames);

  assert(all_frames || source != nullptr);

  const auto write_stripes = [&](auto&& write_lines) {
    for_each_stripe(header, [&](int first, int last) {
      stripe.move_to(first, last);
      if (!all_frames) {
        reading(source->fileName(), [&] {
          source->setFrameBuffer(stripe.frame_buffer(std::not_fn(is_frames)));
          source->readPixels(first, last);
        });
      }
      for (Stripe::Plane& plane : stripe.planes()) {
        if (!is_frames(plane)) continue;
        convert(from_frame.at(plane.channel), frame_origin,
                Imath::Box2i({window.min.x, first}, {window.max.x, last}), plane, report);
      }
      write_lines(first, last, stripe.frame_buffer([](const Stripe::Plane&) { return true; }));
    });
  };

  if (is_tiled(header)) {
    Imf::TiledOutputPart out(file, part);
    const int tile_height = static_cast<int>(header.tileDescription().ySize);
    write_stripes([&](int first, int last, const Imf::FrameBuffer& pixels) {
      out.setFrameBuffer(pixels);
      out.writeTiles(0, out.numXTiles() - 1, (first - window.min.y) / tile_height,
                     (last - window.min.y) / tile_height);
    });
  } else {
    Imf::OutputPart out(file, part);
    write_stripes([&](int first, int last, const Imf::FrameBuffer& pixels) {
      out.setFrameBuffer(pixels);
      out.writePixels(last - first + 1);
    });
  }
}

template <class InputPart, class OutputPart>
void copy_as(Imf::MultiPartInputFile& from, Imf::MultiPartOutputFile& to, int part) {
  InputPart in(from, part);
  OutputPart(to, part).copyPixels(in);
}

/// Copies a part's chunks as they are, still compressed.
void copy_part(Imf::MultiPartInputFile& from, Imf::MultiPartOutputFile& to, int part) {
  const Imf::Header& header = from.header(part);
  if (is_deep(header)) {
    is_tiled(header) ? copy_as<Imf::DeepTiledInputPart, Imf::DeepTiledOutputPart>(from, to, part)
                     : copy_as<Imf::DeepScanLineInputPart, Imf::DeepScanLineOutputPart>(from, to, part);
  } else {
    is_tiled(header) ? copy_as<Imf::TiledInputPart, Imf::TiledOutputPart>(from, to, part)
                     : copy_as<Imf::InputPart, Imf::OutputPart>(from, to, part);
  }
}

/// Runs `work` on a file that appears at `path` when it returns, turning what OpenEXR throws into
/// Error(resource).
void writing(const std::string& path, const std::vector<Imf::Header>& headers,
             const std::function<void(Imf::MultiPartOutputFile&)>& work) {
  AtomicStream stream(path);
  try {
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()));
    work(file);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ExitStatus::resource, fmt::format("{}: cannot be written: {}", path, error.what()));
  }
  stream.commit();
}

/// Adds the AOV as a layer under the table's name (bare for the beauty).
void add_layer(const Frame& frame, Aov aov, Imf::PixelType type, Imf::Header& header,
               FrameChannels& channels) {
  for (int c = 0; c < channel_count(aov); ++c) {
    const char letter = info(aov).channels[c];
    const std::string name =
        info(aov).name.empty() ? std::string(1, letter) : fmt::format("{}.{}", info(aov).name, letter);
    header.channels().insert(name, Imf::Channel(type));
    channels[name] = {&frame.image(aov), c};
  }
}

std::string light_channel(const LightGroup& group, int c) {
  return fmt::format("light.{}.{}", group.name, "RGB"[c]);
}

/// Adds a light group's radiance as the layer light.NAME.
void add_light_group(const LightGroup& group, Imf::PixelType type, Imf::Header& header,
                     FrameChannels& channels) {
  for (int c = 0; c < 3; ++c) {
    const std::string name = light_channel(group, c);
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

/// Whether a denoised frame's image takes the place of its source's.
bool is_denoised(Aov aov) {
  return aov == Aov::beauty || aov == Aov::direct || aov == Aov::indirect;
}

}  // namespace

WriteReport write_exr(const std::string& path, const Frame& frame, const Attributes& attributes,
                      PixelType color_type) {
  Imf::Header header(frame.width(), frame.height());
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  insert_attributes(header, attributes);
  const Imf::PixelType color = color_type == PixelType::half ? Imf::HALF : Imf::FLOAT;
  FrameChannels channels;
  for (const AovInfo& entry : kAovTable) {
    if (!frame.has(entry.aov)) continue;
    add_layer(frame, entry.aov, is_always_float(entry.aov) ? Imf::FLOAT : color, header, channels);
  }
  for (const LightGroup& group : frame.light_groups()) add_light_group(group, color, header, channels);
  WriteReport report;
  writing(path, {header}, [&](Imf::MultiPartOutputFile& file) {
    write_part(file, 0, channels, Imath::V2i(0), nullptr, report);
  });
  return report;
}

std::span<const std::string_view> compression_names() {
  return kCompressions;
}

WriteReport write_denoised_exr(const std::string& path, const Frame& frame, const ExrContents& source,
                               const LayerMap& layers, const Attributes& attributes,
                               const DenoisedFormat& format) {
  WriteReport report;
  std::unique_ptr<Imf::MultiPartInputFile> from;
  reading(source.path(), [&] {
    if (stamp_of(source.path()) != source.stamp()) {
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: changed after it was read; its other channels cannot be passed on",
                              source.path()));
    }
    from = open_exr(source.path());
  });

  const LayerSource& beauty = *layers[static_cast<std::size_t>(Aov::beauty)];
  std::vector<Imf::Header> headers;
  headers.reserve(from->parts());
  for (int part = 0; part < from->parts(); ++part) headers.push_back(from->header(part));
  Imf::Header& header = headers[beauty.part];
  const Imath::V2i size = source.frame_window().size() + Imath::V2i(1);
  if (size != Imath::V2i(frame.width(), frame.height()) || !frame.has(Aov::beauty)) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: {}x{} pixels, but the denoised frame has {}x{}", source.path(), size.x,
                            size.y, frame.width(), frame.height()));
  }

  FrameChannels channels;
  FrameChannels diagnostics;
  for (const AovInfo& entry : kAovTable) {
    if (!frame.has(entry.aov)) continue;
    const std::optional<LayerSource>& layer = layers[static_cast<std::size_t>(entry.aov)];
    if (entry.diagnostic) {
      add_layer(frame, entry.aov, Imf::FLOAT, header, diagnostics);
    } else if (is_denoised(entry.aov)) {
      for (std::size_t c = 0; c < layer->channels.size(); ++c) {
        if (!layer->channels[c].empty())
          channels[layer->channels[c]] = {&frame.image(entry.aov), static_cast<int>(c)};
      }
    }
  }
  for (const LightGroup& group : frame.light_groups()) {
    for (int c = 0; c < 3; ++c) channels[light_channel(group, c)] = {&group.radiance, c};
  }
  if (format.type) {
    for (const auto& [name, channel] : channels) {
      header.channels()[name].type = *format.type == PixelType::half ? Imf::HALF : Imf::FLOAT;
    }
  }
  channels.merge(diagnostics);
  const Imf::Compression source_compression = header.compression();
  if (format.compression) {
    const auto at = std::ranges::find(kCompressions, *format.compression);
    header.compression() = static_cast<Imf::Compression>(at - std::begin(kCompressions));
  }
  const bool rounds_floats =
      header.compression() == Imf::PXR24_COMPRESSION && source_compression != Imf::PXR24_COMPRESSION;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (channels.contains(it.name())) continue;
    const Imf::PixelType type = it.channel().type;
    if (!may_alter(header.compression(), it.name(), type) && !(rounds_floats && type == Imf::FLOAT)) continue;
    header.compression() = Imf::ZIP_COMPRESSION;
    report.lossless_instead = true;
  }
  // The smaller levels of a mipmap show the noisy beauty, so only the full size is written.
  if (is_tiled(header)) {
    Imf::TileDescription tiles = header.tileDescription();
    report.full_size_only = tiles.mode != Imf::ONE_LEVEL;
    tiles.mode = Imf::ONE_LEVEL;
    header.setTileDescription(tiles);
  }
  if (header.hasChunkCount()) header.setChunkCount(static_cast<int>(chunk_count(header)));
  insert_attributes(headers.front(), attributes);
  if (beauty.part != 0) insert_attributes(header, attributes);

  writing(path, headers, [&](Imf::MultiPartOutputFile& file) {
    for (int part = 0; part < from->parts(); ++part) {
      if (part == beauty.part) {
        Imf::InputPart in(*from, part);
        write_part(file, part, channels, source.frame_window().min, &in, report);
      } else {
        copy_part(*from, file, part);
      }
    }
  });
  return report;
}

}  // namespace becalm::io
