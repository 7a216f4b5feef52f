#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfTileDescription.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "frame/io/exr_file.h"

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

std::string text_of(const Imath::Box2i& window) {
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

std::string describe_part(int number, const Imf::Header& header) {
  const std::string name = header.hasName() ? fmt::format(" '{}'", header.name()) : "";
  return fmt::format("part {}{}: {}, {}, data window {}, display window {}", number, name, storage_of(header),
                     name_of(header.compression()), text_of(header.dataWindow()),
                     text_of(header.displayWindow()));
}

/// What is done to the values of an AOV's channel when they are read, such as ` negated`.
std::string change_of(const LayerSource& source, std::size_t channel) {
  const float scale = source.scale[channel];
  std::string change = source.squared ? " squared" : "";
  if (scale < 0.0f) change += " negated";
  if (std::abs(scale) != 1.0f) change += fmt::format(" times {:.6g}", std::abs(scale));
  return change;
}

/// What the channel was taken for, such as `albedo.R` or `right beauty.G`, or that it is passed on.
std::string use_of(const std::vector<ViewLayers>& views, int part, const std::string& channel) {
  std::vector<std::string> uses;
  for (const ViewLayers& view : views) {
    for (const AovInfo& entry : kAovTable) {
      const std::optional<LayerSource>& source = view.layers[static_cast<std::size_t>(entry.aov)];
      if (!source || source->part != part) continue;
      for (std::size_t i = 0; i < source->channels.size(); ++i) {
        if (source->channels[i] != channel) continue;
        uses.push_back(fmt::format("{}{}{}.{}{}", view.view, view.view.empty() ? "" : " ",
                                   entry.aov == Aov::beauty ? "beauty" : entry.name, entry.channels[i],
                                   change_of(*source, i)));
      }
    }
  }
  return uses.empty() ? "passed on" : fmt::format("{}", fmt::join(uses, ", "));
}

}  // namespace

std::vector<std::string> describe_exr(const std::string& path, const LayerOptions& options) {
  std::vector<std::string> lines;
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    const std::vector<PartChannels> parts = part_channels(*file);
    std::vector<ViewLayers> views;
    std::string failure;
    try {
      views = find_view_layers(path, parts, options);
    } catch (const Error& error) {
      failure = error.what();
    }
    lines.push_back(
        fmt::format("{}: EXR with {} part{}", path, file->parts(), file->parts() == 1 ? "" : "s"));
    for (int part = 0; part < file->parts(); ++part) {
      const Imf::Header& header = file->header(part);
      lines.push_back(describe_part(part, header));
      std::size_t width = 0;
      for (const std::string& name : parts[part].channels) width = std::max(width, name.size());
      for (const std::string& name : parts[part].channels) {
        lines.push_back(fmt::format("  {:<{}}  {:<5}  {}", name, width, name_of(header.channels()[name].type),
                                    use_of(views, part, name)));
      }
    }
    if (!failure.empty()) lines.push_back(failure);
  });
  return lines;
}

}  // namespace becalm::io
