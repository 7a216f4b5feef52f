#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfTileDescription.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "frame/io/exr_file.h"
#include "frame/io/printable.h"

namespace becalm::io {
namespace {

std::string_view name_of(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return "uncompressed";
    case Imf::RLE_COMPRESSION:
      return "RLE";
    case Imf::ZIPS_COMPRESSION:
      return "ZIPS";
    case Imf::ZIP_COMPRESSION:
      return "ZIP";
    case Imf::PIZ_COMPRESSION:
      return "PIZ";
    case Imf::PXR24_COMPRESSION:
      return "PXR24";
    case Imf::B44_COMPRESSION:
      return "B44";
    case Imf::B44A_COMPRESSION:
      return "B44A";
    case Imf::DWAA_COMPRESSION:
      return "DWAA";
    case Imf::DWAB_COMPRESSION:
      return "DWAB";
    case Imf::NUM_COMPRESSION_METHODS:
      break;
  }
  return "unknown compression";
}

std::string_view name_of(Imf::PixelType type) {
  switch (type) {
    case Imf::UINT:
      return "uint";
    case Imf::HALF:
      return "half";
    case Imf::FLOAT:
      return "float";
    case Imf::NUM_PIXELTYPES:
      break;
  }
  return "unknown type";
}

std::string size_and_place(const Imath::Box2i& window) {
  return fmt::format("{}x{} at ({}, {})", window.max.x - window.min.x + 1, window.max.y - window.min.y + 1,
                     window.min.x, window.min.y);
}

std::string storage_of(const Imf::Header& header) {
  std::string text = is_deep(header) ? "deep " : "";
  if (!is_tiled(header)) return text + "scanlines";
  const Imf::TileDescription& tiles = header.tileDescription();
  text += fmt::format("tiles of {}x{}", tiles.xSize, tiles.ySize);
  if (tiles.mode == Imf::MIPMAP_LEVELS) text += " with mipmaps";
  if (tiles.mode == Imf::RIPMAP_LEVELS) text += " with ripmaps";
  return text;
}

/// What is done to the values of an AOV's channel when they are read, such as ` negated`.
std::string change_of(const LayerSource& source, std::size_t channel) {
  const float scale = source.scale[channel];
  std::string change = source.squared ? " squared" : "";
  if (scale < 0.0f) change += " negated";
  if (std::abs(scale) != 1.0f) change += fmt::format(" times {:.6g}", std::abs(scale));
  return change;
}

/// What the channel was taken for, such as `albedo.R`, `right beauty.G` or `light key.B`, or that it is
/// passed on.
std::string use_of(const std::vector<ViewLayers>& views, int part, const std::string& channel) {
  std::vector<std::string> uses;
  for (const ViewLayers& view : views) {
    const auto add = [&](const LayerSource& source, const std::string& name, std::string_view letters) {
      for (std::size_t i = 0; i < source.channels.size(); ++i) {
        if (source.part != part || source.channels[i] != channel) continue;
        uses.push_back(fmt::format("{}{}{}.{}{}", printable(view.view), view.view.empty() ? "" : " ", name,
                                   letters[i], change_of(source, i)));
      }
    };
    for (const AovInfo& entry : kAovTable) {
      const std::optional<LayerSource>& source = view.layers[static_cast<std::size_t>(entry.aov)];
      if (source) add(*source, std::string(entry.aov == Aov::beauty ? "beauty" : entry.name), entry.channels);
    }
    for (const auto& [name, light] : view.lights) add(light.layer, "light " + printable(name), "RGB");
  }
  return uses.empty() ? "passed on" : fmt::format("{}", fmt::join(uses, ", "));
}

}  // namespace

std::vector<std::string> ExrDescription::lines() const {
  std::vector<std::string> lines;
  for (std::size_t number = 0; number < parts.size(); ++number) {
    const Part& part = parts[number];
    lines.push_back(fmt::format("part {}{}: {}, {}, data window {}, display window {}", number,
                                part.name.empty() ? "" : fmt::format(" '{}'", part.name), part.storage,
                                part.compression, size_and_place(part.data_window),
                                size_and_place(part.display_window)));
    std::size_t width = 0;
    for (const Channel& channel : part.channels) width = std::max(width, channel.name.size());
    for (const Channel& channel : part.channels) {
      lines.push_back(fmt::format("  {:<{}}  {:<5}  {}", channel.name, width, channel.type, channel.use));
    }
  }
  for (const std::string& other : other_beauties) {
    lines.push_back(
        fmt::format("{0} is passed on as it is; --layers 'beauty={0}' denoises it instead", other));
  }
  if (is_checkerboard)
    lines.push_back("a checkerboard of pixels: becalm antialias --checkerboard makes it whole");
  return lines;
}

ExrDescription describe_exr(const std::string& path, const LayerOptions& options, AovSet taken) {
  ExrDescription description;
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    description.is_checkerboard = is_checkerboard(*file);
    const std::vector<PartChannels> parts = part_channels(*file);
    std::vector<ViewLayers> views;
    try {
      require_flat(path, *file);
      views = find_view_layers(path, parts, options);
      require_all_chunks(path, *file);
      for (const ViewLayers& view : views) require_all_samples(path, view, taken, LightGroups::read);
    } catch (const Error& error) {
      description.problem = error.what();
    }
    for (const ViewLayers& view : views) {
      const LayerSource& beauty = *view.layers[static_cast<std::size_t>(Aov::beauty)];
      for (const std::string& other : find_other_beauties(parts, beauty, view.view))
        description.other_beauties.push_back(printable(other));
    }
    for (int number = 0; number < file->parts(); ++number) {
      const Imf::Header& header = file->header(number);
      ExrDescription::Part& part = description.parts.emplace_back();
      if (header.hasName()) part.name = printable(header.name());
      part.storage = storage_of(header);
      part.compression = name_of(header.compression());
      part.data_window = header.dataWindow();
      part.display_window = header.displayWindow();
      for (const std::string& name : parts[number].channels) {
        part.channels.push_back({printable(name), std::string(name_of(header.channels()[name].type)),
                                 use_of(views, number, name)});
      }
    }
  });
  return description;
}

}  // namespace becalm::io
