#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <list>
#include <map>
#include <optional>
#include <set>

#include "frame/error.h"
#include "frame/io/coloured_light.h"
#include "frame/io/cryptomatte.h"
#include "frame/io/exr_file.h"
#include "frame/io/exr_parts.h"
#include "frame/io/printable.h"
#include "frame/io/stereo_text.h"

namespace becalm::io {
namespace {

/// The names of OpenEXR's methods, in the order of its enumeration.
constexpr std::string_view kCompressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                              "pxr24", "b44", "b44a", "dwaa", "dwab"};
static_assert(std::size(kCompressions) == Imf::NUM_COMPRESSION_METHODS);

/// Whether pixels that were decompressed from this method may change when they are compressed by it again.
/// PXR24 drops bits that are zero by then; B44, and the cosine transform that DWA applies to channels of some
/// names, lose something each time.
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

const LayerSource& beauty_of(const LoadedView& view) {
  return *view.layers[static_cast<std::size_t>(Aov::beauty)];
}

/// What becomes of the parts of a file that is written again.
struct Rewritten {
  std::vector<Imf::Header> headers;
  std::map<int, FrameChannels> channels;  ///< of the parts that are not copied
  std::list<Image> light;                 ///< radiance without the surfaces' colours
  std::optional<PixelType> type;          ///< of replaced channels; the source's if empty
  bool keeps_alpha = false;               ///< as DenoisedFormat has it
  Scale scale;                            ///< of the headers' windows, over the source's
  bool resamples = false;                 ///< whether pixels are others than the source's
  bool diagnostics_replace = false;       ///< whether diagnostics take the places of channels of the source
};

/// Scales the windows of a flat part's header. Channels at a part of the resolution get all of it.
void scale_windows(const Scale& scale, Imf::Header& header) {
  header.dataWindow() = scale.window(header.dataWindow());
  header.displayWindow() = scale.window(header.displayWindow());
  if (std::optional<StereoView> view = parse_stereo(text_attribute(header, kStereoAttribute))) {
    view->camera.focal_px *= scale.value();
    header.insert(kStereoAttribute, Imf::StringAttribute(format_stereo(*view)));
  }
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    it.channel().xSampling = it.channel().ySampling = 1;
  }
}

/// The sample next to each pixel of a scaled part.
NearestSample nearest_in(const Imf::Header& source, const LoadedView& view, const Scale& scale) {
  NearestSample nearest{.scale = scale, .window = source.dataWindow()};
  if (const auto& jitter = view.frame.jitter(); jitter && jitter->positions_px.size() == 1) {
    nearest.position_px = jitter->positions_px.front();
  }
  if (view.frame.checkerboard()) {
    const Imath::V2i away = nearest.window.min - view.window.min;
    const bool is_odd = (*view.frame.checkerboard() == Parity::odd) != (((away.x + away.y) & 1) != 0);
    nearest.checkerboard = is_odd ? Parity::odd : Parity::even;
  }
  return nearest;
}

/// The channels of a part that hold motion in pixels: those that were taken for it and, of Blender's X Y Z W,
/// the other two, which lead to the next frame.
std::set<std::string> motion_channels_of(const std::vector<const ViewLayers*>& views, int part,
                                         const Imf::ChannelList& channels) {
  std::set<std::string> names;
  for (const ViewLayers* view : views) {
    const auto& motion = view->layers[static_cast<std::size_t>(Aov::motion)];
    if (!motion || motion->part != part) continue;
    names.insert(motion->channels.begin(), motion->channels.end());
    const std::string& first = motion->channels.front();
    const std::string layer = first.substr(0, first.size() - 1);  // without the letter
    const std::set<std::string> to_next{layer + "Z", layer + "W"};
    const auto is_there = [&](const std::string& name) { return channels.findChannel(name) != nullptr; };
    if (std::ranges::all_of(to_next, is_there)) names.insert(to_next.begin(), to_next.end());
  }
  return names;
}

void replace(const LayerSource& layer, const Image& image, const Imath::V2i& origin, Rewritten& file) {
  for (std::size_t c = 0; c < layer.channels.size(); ++c) {
    const std::string& name = layer.channels[c];
    if (name.empty()) continue;
    const bool passed_on = file.keeps_alpha && c == 3;
    file.channels[layer.part][name] = {&image, static_cast<int>(c), origin, passed_on};
    if (file.type && !passed_on) {
      file.headers[layer.part].channels()[name].type = *file.type == PixelType::half ? Imf::HALF : Imf::FLOAT;
    }
  }
}

std::size_t number_of_channels(const Imf::Header& header) {
  std::size_t count = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++count;
  return count;
}

/// Puts a denoised frame in the place of the view that it was made from. `diagnostics_view` tells its
/// diagnostics from those of another view in the same part.
void replace_view(const std::string& path, const LoadedView& view, const Frame& frame,
                  const std::string& diagnostics_view, Rewritten& file) {
  const LayerSource& beauty = beauty_of(view);
  Imf::Header& header = file.headers[beauty.part];
  const Imath::Box2i scaled = file.scale.window(view.window);
  const Imath::V2i& origin = scaled.min;
  const Imath::V2i size = scaled.size() + Imath::V2i(1);
  if (size != Imath::V2i(frame.width(), frame.height()) || !frame.has(Aov::beauty)) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: {}x{} pixels, but the denoised frame has {}x{}", path,
                                                   size.x, size.y, frame.width(), frame.height()));
  }
  const Imath::Box2i& needed = header.dataWindow();
  if (!scaled.intersects(needed.min) || !scaled.intersects(needed.max)) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: its data window is not inside the denoised frame's", path));
  }
  for (const AovInfo& entry : kAovTable) {
    if (!frame.has(entry.aov)) continue;
    if (entry.diagnostic) {
      const std::size_t before = number_of_channels(header);
      add_layer(frame, entry.aov, diagnostics_view, Imf::FLOAT, origin, header, file.channels[beauty.part]);
      file.diagnostics_replace |=
          number_of_channels(header) < before + static_cast<std::size_t>(entry.channels.size());
    } else if (is_denoised(entry.aov)) {
      replace(*view.layers[static_cast<std::size_t>(entry.aov)], frame.image(entry.aov), origin, file);
    }
  }
  for (const LightGroup& group : frame.light_groups()) {
    const auto colour = view.colours.find(group.name);
    const Image& light =
        colour == view.colours.end()
            ? group.radiance
            : file.light.emplace_back(light_without_colour(
                  group.radiance, colour->second,
                  std::ranges::find(view.frame.light_groups(), group.name, &LightGroup::name)->radiance));
    replace(view.lights.at(group.name).layer, light, origin, file);
  }
}

/// Whether the selection names the channel of a part, which may have a name. `beauty`: the part's channels
/// that the name `beauty` selects.
bool is_named(const ChannelSelection& selection, const std::string& part, const std::string& channel,
              const std::vector<std::string>& beauty) {
  return std::ranges::any_of(selection.names, [&](std::string name) {
    if (name == "beauty" && std::ranges::find(beauty, channel) != beauty.end()) return true;
    if (!part.empty() && name == part) return true;
    if (!part.empty() && name.starts_with(part + '/')) name.erase(0, part.size() + 1);
    return channel == name || channel.starts_with(name + '.');
  });
}

std::string name_of_part(const Imf::MultiPartInputFile& file, int part) {
  return file.parts() > 1 && file.header(part).hasName() ? file.header(part).name() : "";
}

/// Whether all channels of a deep part are selected: it is written whole or not at all.
bool is_selected(const ChannelSelection& selection, const Imf::MultiPartInputFile& file, int deep_part) {
  if (selection.selects_all()) return true;
  const Imf::ChannelList& channels = file.header(deep_part).channels();
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    if (!is_named(selection, name_of_part(file, deep_part), it.name(), {})) return false;
  }
  return true;
}

void refuse_deep_parts(const std::string& path, const Imf::MultiPartInputFile& file,
                       const ChannelSelection& selection) {
  for (int part = 0; part < file.parts(); ++part) {
    if (!is_deep(file.header(part)) || !is_selected(selection, file, part)) continue;
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: has a deep part, which cannot be scaled: --channels leaves it out", path));
  }
}

/// The beauties' channels of a part, in all views.
std::vector<std::string> beauty_channels(const std::vector<const ViewLayers*>& views, int part) {
  std::vector<std::string> names;
  for (const ViewLayers* view : views) {
    const LayerSource& beauty = *view->layers[static_cast<std::size_t>(Aov::beauty)];
    if (beauty.part == part) names.insert(names.end(), beauty.channels.begin(), beauty.channels.end());
  }
  return names;
}

/// Leaves channels out that are not selected. Returns whether the part is left with any.
bool select_channels(const ChannelSelection& selection, const std::vector<std::string>& beauty,
                     const Imf::MultiPartInputFile& from, int part, Rewritten& file) {
  if (is_deep(from.header(part))) return is_selected(selection, from, part);
  if (selection.selects_all()) return true;
  Imf::Header& header = file.headers[part];
  const auto replaced = file.channels.find(part);
  const std::string name = name_of_part(from, part);
  Imf::ChannelList kept;
  bool all = true;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    const bool is_denoised = replaced != file.channels.end() && replaced->second.contains(it.name());
    if ((selection.denoised && is_denoised) || is_named(selection, name, it.name(), beauty)) {
      kept.insert(it.name(), it.channel());
    } else {
      all = false;
    }
  }
  if (all) return true;
  if (kept.begin() == kept.end()) return false;
  header.channels() = kept;
  file.channels[part];  // its chunks hold channels that are left out
  return true;
}

/// Whether the stripe holds all channels of the part but those that the frame replaces.
bool has_others(const Stripe& kept, const Imf::Header& header, const FrameChannels& replaced) {
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (!replaced.contains(it.name()) && kept.plane_of(it.name()) == nullptr) return false;
  }
  return true;
}

/// Chooses how the pixels of a part that is not copied are stored: by `compression` (one of kCompressions),
/// or as they are.
void prepare_header(const FrameChannels& channels, const std::optional<std::string>& compression,
                    Imf::Header& header, WriteReport& report) {
  const Imf::Compression source_compression = header.compression();
  if (compression) {
    const auto at = std::ranges::find(kCompressions, *compression);
    header.compression() = static_cast<Imf::Compression>(at - std::begin(kCompressions));
  }
  const bool rounds_floats =
      header.compression() == Imf::PXR24_COMPRESSION && source_compression != Imf::PXR24_COMPRESSION;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    const auto of_frame = channels.find(it.name());
    if (of_frame != channels.end() && !of_frame->second.passed_on) continue;
    const Imf::PixelType type = it.channel().type;
    if (!may_alter(header.compression(), it.name(), type) && !(rounds_floats && type == Imf::FLOAT)) continue;
    header.compression() = Imf::ZIP_COMPRESSION;
    report.lossless_instead = true;
  }
  // The smaller levels of a mipmap show the noisy beauty, so only the full size is written.
  if (is_tiled(header)) {
    Imf::TileDescription tiles = header.tileDescription();
    if (tiles.mode != Imf::ONE_LEVEL) report.full_size_only = true;
    tiles.mode = Imf::ONE_LEVEL;
    header.setTileDescription(tiles);
  }
  if (header.hasChunkCount()) header.setChunkCount(static_cast<int>(chunk_count(header)));
}

/// Opens the file that the frame was loaded from. Throws Error(bad_input) if it has changed since.
std::unique_ptr<Imf::MultiPartInputFile> open_unchanged(const LoadedFrame& source) {
  const std::string& path = source.contents->path();
  std::unique_ptr<Imf::MultiPartInputFile> file;
  reading(path, [&] {
    if (stamp_of(path) != source.contents->stamp()) {
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: changed after it was read; its other channels cannot be passed on", path));
    }
    file = open_exr(path);
  });
  return file;
}

/// The parts of `from` with the denoised frames in place of the views they were made from.
Rewritten replace_views(const Imf::MultiPartInputFile& from, const Frame& frame,
                        const std::vector<Frame>& other_views, const LoadedFrame& source,
                        const DenoisedFormat& format) {
  const std::string& path = source.contents->path();
  Rewritten rewritten;
  rewritten.type = format.type;
  rewritten.keeps_alpha = format.keeps_alpha;
  rewritten.headers.reserve(from.parts());
  rewritten.scale = format.scale;
  rewritten.resamples = !format.scale.is_one() || source.frame.checkerboard().has_value();
  for (int part = 0; part < from.parts(); ++part) rewritten.headers.push_back(from.header(part));
  if (rewritten.resamples) {
    refuse_deep_parts(path, from, format.channels);
    for (Imf::Header& header : rewritten.headers) {
      if (!is_deep(header)) scale_windows(format.scale, header);
    }
  }
  replace_view(path, source, frame, "", rewritten);
  for (std::size_t i = 0; i < other_views.size(); ++i) {
    const LoadedView& view = source.other_views.at(i);
    const bool has_own_part = beauty_of(view).part != beauty_of(source).part;
    replace_view(path, view, other_views[i], has_own_part ? "" : view.view, rewritten);
  }
  return rewritten;
}

}  // namespace

std::span<const std::string_view> compression_names() {
  return kCompressions;
}

void check_selection(const std::string& path, const LayerOptions& options, const ChannelSelection& selection,
                     std::string_view option) {
  if (selection.selects_all()) return;
  reading(path, [&] {
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    const std::vector<ViewLayers> found = find_view_layers(path, part_channels(*file), options);
    std::vector<const ViewLayers*> views;
    views.reserve(found.size());
    for (const ViewLayers& view : found) views.push_back(&view);
    for (const std::string& name : selection.names) {
      bool is_there = false;
      for (int part = 0; part < file->parts(); ++part) {
        const Imf::Header& header = file->header(part);
        if (is_deep(header) && !is_selected(selection, *file, part)) continue;
        const std::vector<std::string> beauty = beauty_channels(views, part);
        for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
          is_there |= is_named({.names = {name}}, name_of_part(*file, part), it.name(), beauty);
        }
      }
      if (is_there) continue;
      throw Error(ExitStatus::usage,
                  fmt::format("{} {}: {} has no such channel or layer; becalm info lists them", option,
                              printable(name), path));
    }
  });
}

void check_scaling(const std::string& path, const ChannelSelection& selection) {
  reading(path, [&] { refuse_deep_parts(path, *open_exr(path), selection); });
}

WriteReport write_denoised_exr(const std::string& path, const Frame& frame,
                               const std::vector<Frame>& other_views, const LoadedFrame& source,
                               const Attributes& attributes, const DenoisedFormat& format) {
  const std::string& source_path = source.contents->path();
  const std::unique_ptr<Imf::MultiPartInputFile> from = open_unchanged(source);
  Rewritten rewritten = replace_views(*from, frame, other_views, source, format);
  std::vector<const ViewLayers*> views{&source};
  for (const LoadedView& view : source.other_views) views.push_back(&view);
  std::set<int> with_denoised;
  for (const auto& [part, channels] : rewritten.channels) with_denoised.insert(part);
  std::vector<int> kept;
  for (int part = 0; part < from->parts(); ++part) {
    if (select_channels(format.channels, beauty_channels(views, part), *from, part, rewritten))
      kept.push_back(part);
  }
  if (kept.empty()) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: holds none of the channels to write", source_path));
  }
  WriteReport report;
  const bool is_own = !text_attribute(from->header(0), "becalm:version").empty();
  report.diagnostics_replace = rewritten.diagnostics_replace && !is_own;
  std::vector<Imf::Header> headers;
  for (const int part : kept) {
    Imf::Header& header = headers.emplace_back(rewritten.headers[part]);
    if (rewritten.resamples) rewritten.channels[part];  // no part is copied
    const auto channels = rewritten.channels.find(part);
    const bool is_denoised = with_denoised.contains(part);
    if (channels != rewritten.channels.end()) {
      prepare_header(channels->second, is_denoised ? format.compression : std::nullopt, header, report);
    }
    if (is_denoised || part == kept.front()) insert_attributes(header, attributes);
  }
  if (!format.channels.selects_all()) {
    std::vector<Imf::Header> before;
    for (int part = 0; part < from->parts(); ++part) before.push_back(from->header(part));
    leave_out_mattes(before, headers);
  }

  const auto open_part = [&](int part) {
    std::unique_ptr<Imf::InputPart> in;
    reading(source_path, [&] { in = std::make_unique<Imf::InputPart>(*from, part); });
    return in;
  };
  writing(path, headers, [&](Imf::MultiPartOutputFile& file) {
    for (std::size_t number = 0; number < kept.size(); ++number) {
      const auto channels = rewritten.channels.find(kept[number]);
      if (rewritten.resamples) {
        const auto in = open_part(kept[number]);
        write_scaled_part(file, static_cast<int>(number), channels->second, *in,
                          nearest_in(in->header(), source, format.scale),
                          motion_channels_of(views, kept[number], in->header().channels()), report);
        continue;
      }
      if (channels == rewritten.channels.end()) {
        reading(source_path, [&] { copy_part(*from, kept[number], file, static_cast<int>(number)); });
        continue;
      }
      const Stripe* read_before = source.contents->kept(kept[number]);
      if (read_before != nullptr && has_others(*read_before, headers[number], channels->second)) {
        const auto copy = [&](Stripe& stripe, const std::function<bool(const Stripe::Plane&)>& wanted) {
          for (Stripe::Plane& plane : stripe.planes()) {
            if (wanted(plane)) stripe.copy_lines(*read_before, plane);
          }
        };
        write_part(file, static_cast<int>(number), channels->second, copy, report);
        continue;
      }
      const auto in = open_part(kept[number]);
      write_part(file, static_cast<int>(number), channels->second, lines_of(*in), report);
    }
  });
  return report;
}

}  // namespace becalm::io
