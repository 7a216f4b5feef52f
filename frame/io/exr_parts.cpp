#include "frame/io/exr_parts.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <OpenEXR/ImfDeepTiledOutputPart.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>

#include "frame/error.h"
#include "frame/io/atomic_file.h"
#include "frame/io/exr_file.h"
#include "frame/io/samples.h"
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

/// Converts a window of the file to the plane's type.
void convert(const FrameChannel& from, const Imath::Box2i& window, Stripe::Plane& plane,
             WriteReport& report) {
  std::vector<float> values(static_cast<std::size_t>(window.max.x - window.min.x + 1));
  const std::size_t channels = static_cast<std::size_t>(from.image->channels());
  char* to = plane.bytes.data();
  for (int y = window.min.y; y <= window.max.y; ++y, to += values.size() * size_of(plane.type)) {
    const float* row = &from.image->pixel(window.min.x - from.origin.x, y - from.origin.y)[from.channel];
    for (std::size_t x = 0; x < values.size(); ++x) values[x] = row[x * channels];
    report.half_overflows += to_samples(plane.type, values, to);
  }
}

template <class InputPart, class OutputPart>
void copy_as(Imf::MultiPartInputFile& from, int part, Imf::MultiPartOutputFile& to, int to_part) {
  InputPart in(from, part);
  OutputPart(to, to_part).copyPixels(in);
}

}  // namespace

void add_layer(const Frame& frame, Aov aov, const std::string& view, Imf::PixelType type,
               const Imath::V2i& origin, Imf::Header& header, FrameChannels& channels) {
  for (int c = 0; c < channel_count(aov); ++c) {
    std::string name(info(aov).name);
    for (const std::string& word : {view, std::string(1, info(aov).channels[c])}) {
      if (!word.empty()) name += (name.empty() ? "" : ".") + word;
    }
    header.channels().insert(name, Imf::Channel(type));
    channels[name] = {&frame.image(aov), c, origin};
  }
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

namespace {

/// Writes a part stripe by stripe, after `fill` has put the lines of each stripe into all of its planes.
void write_stripes(Imf::MultiPartOutputFile& file, int part, Stripe& stripe,
                   const std::function<void(int first, int last)>& fill) {
  const Imf::Header& header = file.header(part);
  const Imath::Box2i& window = header.dataWindow();
  const auto write = [&](auto&& write_lines) {
    for_each_stripe(header, [&](int first, int last) {
      stripe.move_to(first, last);
      fill(first, last);
      write_lines(first, last, stripe.frame_buffer([](const Stripe::Plane&) { return true; }));
    });
  };
  if (is_tiled(header)) {
    Imf::TiledOutputPart out(file, part);
    const int tile_height = static_cast<int>(header.tileDescription().ySize);
    write([&](int first, int last, const Imf::FrameBuffer& pixels) {
      out.setFrameBuffer(pixels);
      out.writeTiles(0, out.numXTiles() - 1, (first - window.min.y) / tile_height,
                     (last - window.min.y) / tile_height);
    });
  } else {
    Imf::OutputPart out(file, part);
    write([&](int first, int last, const Imf::FrameBuffer& pixels) {
      out.setFrameBuffer(pixels);
      out.writePixels(last - first + 1);
    });
  }
}

Stripe planes_of(const Imf::Header& header) {
  Stripe stripe(header.dataWindow());
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    stripe.add(it.name(), it.channel().type, it.channel().xSampling, it.channel().ySampling);
  }
  return stripe;
}

/// Whole numbers stay.
void multiply(char* sample, Imf::PixelType type, float factor, WriteReport& report) {
  if (type == Imf::UINT) return;
  float value = 0.0f;
  from_samples(type, sample, {&value, 1});
  value *= factor;
  report.half_overflows += to_samples(type, {&value, 1}, sample);
}

}  // namespace

ReadLines lines_of(Imf::InputPart& part) {
  return [&part](Stripe& stripe, const std::function<bool(const Stripe::Plane&)>& wanted) {
    reading(part.fileName(), [&] {
      part.setFrameBuffer(stripe.frame_buffer(wanted));
      part.readPixels(stripe.lines().min.y, stripe.lines().max.y);
    });
  };
}

void write_part(Imf::MultiPartOutputFile& file, int part, const FrameChannels& from_frame,
                const ReadLines& read, WriteReport& report) {
  Stripe stripe = planes_of(file.header(part));
  const Imath::Box2i& window = file.header(part).dataWindow();
  const auto is_frames = [&](const Stripe::Plane& plane) { return from_frame.contains(plane.channel); };
  const bool all_frames = std::all_of(stripe.planes().begin(), stripe.planes().end(), is_frames);

  assert(all_frames || read != nullptr);

  write_stripes(file, part, stripe, [&](int first, int last) {
    if (!all_frames) read(stripe, std::not_fn(is_frames));
    for (Stripe::Plane& plane : stripe.planes()) {
      if (!is_frames(plane)) continue;
      convert(from_frame.at(plane.channel), Imath::Box2i({window.min.x, first}, {window.max.x, last}), plane,
              report);
    }
  });
}

void write_scaled_part(Imf::MultiPartOutputFile& file, int part, const FrameChannels& from_frame,
                       Imf::InputPart& source, const NearestSample& nearest,
                       const std::set<std::string>& motion_channels, WriteReport& report) {
  const Imath::Box2i& window = file.header(part).dataWindow();
  const Imath::Box2i from = source.header().dataWindow();
  Stripe whole = planes_of(source.header());
  whole.move_to(from.min.y, from.max.y);
  lines_of(source)(whole, [](const Stripe::Plane&) { return true; });
  Stripe stripe = planes_of(file.header(part));
  write_stripes(file, part, stripe, [&](int first, int last) {
    const Imath::Box2i lines({window.min.x, first}, {window.max.x, last});
    for (Stripe::Plane& plane : stripe.planes()) {
      if (const auto image = from_frame.find(plane.channel); image != from_frame.end()) {
        convert(image->second, lines, plane, report);
        continue;
      }
      const auto source_plane = std::ranges::find(whole.planes(), plane.channel, &Stripe::Plane::channel);
      const std::size_t bytes = size_of(plane.type);
      const int columns = (from.max.x - from.min.x) / source_plane->x_sampling + 1;
      const bool is_motion = motion_channels.contains(plane.channel);
      char* to = plane.bytes.data();
      for (int y = first; y <= last; ++y) {
        for (int x = window.min.x; x <= window.max.x; ++x, to += bytes) {
          const Imath::V2i at = nearest.at(x - window.min.x, y - window.min.y);
          const std::size_t index = static_cast<std::size_t>(at.y / source_plane->y_sampling) * columns +
                                    at.x / source_plane->x_sampling;
          std::memcpy(to, &source_plane->bytes[index * bytes], bytes);
          if (is_motion) multiply(to, plane.type, static_cast<float>(nearest.scale.value()), report);
        }
      }
    }
  });
}

void copy_part(Imf::MultiPartInputFile& from, int part, Imf::MultiPartOutputFile& to, int to_part) {
  const Imf::Header& header = from.header(part);
  if (is_deep(header)) {
    is_tiled(header)
        ? copy_as<Imf::DeepTiledInputPart, Imf::DeepTiledOutputPart>(from, part, to, to_part)
        : copy_as<Imf::DeepScanLineInputPart, Imf::DeepScanLineOutputPart>(from, part, to, to_part);
  } else {
    is_tiled(header) ? copy_as<Imf::TiledInputPart, Imf::TiledOutputPart>(from, part, to, to_part)
                     : copy_as<Imf::InputPart, Imf::OutputPart>(from, part, to, to_part);
  }
}

}  // namespace becalm::io
