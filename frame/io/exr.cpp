#include "frame/io/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <map>
#include <string_view>

#include "frame/error.h"
#include "frame/io/exr_file.h"
#include "frame/io/stripe.h"

namespace becalm::io {
namespace {

/// One channel of a frame's image that a file's channel is read into.
struct Target {
  Image* image;
  int channel;
  float scale;
};

using TargetsByChannel = std::map<std::string, std::vector<Target>>;

int width_of(const Imath::Box2i& window) {
  return window.max.x - window.min.x + 1;
}
int height_of(const Imath::Box2i& window) {
  return window.max.y - window.min.y + 1;
}

/// The value of the AOV table for pixels that hit nothing, for what lies outside another part's data window.
float value_of_nothing(Aov aov) {
  if (aov == Aov::albedo) return 1.0f;
  if (aov == Aov::depth) return std::numeric_limits<float>::infinity();
  return 0.0f;
}

/// Copies what the stripe's lines and the frame's window have in common.
void copy_lines(const Stripe::Plane& plane, const Imath::Box2i& lines, const Imath::Box2i& frame_window,
                const Target& target) {
  const int x_begin = std::max(lines.min.x, frame_window.min.x);
  const int x_end = std::min(lines.max.x, frame_window.max.x) + 1;
  for (int y = std::max(lines.min.y, frame_window.min.y); y <= std::min(lines.max.y, frame_window.max.y);
       ++y) {
    const std::size_t row = static_cast<std::size_t>(y - lines.min.y) * width_of(lines);
    for (int x = x_begin; x < x_end; ++x) {
      float value;
      std::memcpy(&value, &plane.bytes[(row + (x - lines.min.x)) * sizeof value], sizeof value);
      target.image->at(x - frame_window.min.x, y - frame_window.min.y, target.channel) = value * target.scale;
    }
  }
}

void read_part(Imf::MultiPartInputFile& file, int part_number, const TargetsByChannel& targets,
               const Imath::Box2i& frame_window) {
  Imf::InputPart part(file, part_number);
  const Imath::Box2i window = part.header().dataWindow();
  Stripe stripe(window);
  for (const auto& entry : targets) stripe.add(entry.first, Imf::FLOAT);
  for_each_stripe(part.header(), [&](int first, int last) {
    stripe.move_to(first, last);
    part.setFrameBuffer(stripe.frame_buffer([](const Stripe::Plane&) { return true; }));
    part.readPixels(first, last);
    const Imath::Box2i lines(Imath::V2i(window.min.x, first), Imath::V2i(window.max.x, last));
    for (const Stripe::Plane& plane : stripe.planes()) {
      for (const Target& target : targets.at(plane.channel)) copy_lines(plane, lines, frame_window, target);
    }
  });
}

constexpr std::string_view kLightGroupPrefix = "light.";

/// NAME for every layer light.NAME.
std::vector<std::string> light_group_names(const std::vector<std::string>& channels) {
  constexpr std::string_view begin = kLightGroupPrefix;
  constexpr std::string_view end = ".R";
  std::vector<std::string> names;
  for (const std::string& channel : channels) {
    if (channel.size() <= begin.size() + end.size() || !channel.starts_with(begin) || !channel.ends_with(end))
      continue;
    names.push_back(channel.substr(begin.size(), channel.size() - begin.size() - end.size()));
  }
  return names;
}

/// Adds a group for every layer light.NAME with the channels R, G and B.
void add_light_groups(const std::vector<std::string>& channels, Frame& frame, TargetsByChannel& targets) {
  std::vector<LightGroup>& groups = frame.light_groups();
  for (std::string& name : light_group_names(channels)) {
    groups.push_back({std::move(name), Image(frame.width(), frame.height(), 3)});
  }
  for (LightGroup& group : groups) {
    for (int c = 0; c < 3; ++c) {
      targets[fmt::format("{}{}.{}", kLightGroupPrefix, group.name, "RGB"[c])].push_back(
          {&group.radiance, c, 1.0f});
    }
  }
}

void require_flat(const std::string& path, const Imf::MultiPartInputFile& file) {
  for (int part = 0; part < file.parts(); ++part) {
    if (!is_deep(file.header(part))) return;
  }
  throw Error(ExitStatus::bad_input, fmt::format("{}: a deep image, expected flat pixels", path));
}

/// The parts of the file that its frame comes from.
ExrHeader header_of(const std::string& path, const Imf::MultiPartInputFile& file,
                    const LayerOverrides& overrides) {
  require_flat(path, file);
  const std::vector<std::vector<std::string>> channels = channel_names(file);
  ExrHeader found;
  found.layers = find_layers(path, channels, overrides);
  const int part = found.layers[static_cast<std::size_t>(Aov::beauty)]->part;
  found.data_window = file.header(part).dataWindow();
  found.display_window = file.header(part).displayWindow();
  found.light_groups = light_group_names(channels[part]);
  return found;
}

}  // namespace

ExrHeader read_exr_header(const std::string& path, const LayerOverrides& overrides,
                          CheckChunks check_chunks) {
  ExrHeader found;
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    found = header_of(path, *file, overrides);
    if (check_chunks == CheckChunks::yes) require_all_chunks(path, *file);
  });
  return found;
}

LoadedFrame read_exr(const std::string& path, int frame_number, AovSet wanted,
                     const LayerOverrides& overrides, LightGroups light_groups,
                     const std::optional<Imath::Box2i>& frame_window) {
  LoadedFrame loaded;
  reading(path, [&] {
    const FileStamp stamp = stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    ExrHeader header = header_of(path, *file, overrides);
    require_all_chunks(path, *file);
    loaded.layers = std::move(header.layers);

    const LayerSource& beauty = *loaded.layers[static_cast<std::size_t>(Aov::beauty)];
    const Imath::Box2i window = frame_window.value_or(header.data_window);
    loaded.contents = std::make_shared<ExrContents>(path, stamp, window);
    loaded.frame = Frame(frame_number, width_of(window), height_of(window));

    wanted.set(static_cast<std::size_t>(Aov::beauty));
    std::map<int, TargetsByChannel> parts;
    for (const AovInfo& entry : kAovTable) {
      const std::size_t index = static_cast<std::size_t>(entry.aov);
      if (!wanted.test(index) || !loaded.layers[index]) continue;
      const LayerSource& source = *loaded.layers[index];
      Image& image = loaded.frame.add(entry.aov, value_of_nothing(entry.aov));
      for (std::size_t c = 0; c < source.channels.size(); ++c) {
        if (source.channels[c].empty()) {  // a beauty without alpha is opaque
          for (std::size_t i = c; i < image.data().size(); i += source.channels.size())
            image.data()[i] = 1.0f;
          continue;
        }
        const float scale = c == 1 ? source.y_scale : 1.0f;
        parts[source.part][source.channels[c]].push_back({&image, static_cast<int>(c), scale});
      }
    }
    if (light_groups == LightGroups::read) {
      add_light_groups(channel_names(*file)[beauty.part], loaded.frame, parts[beauty.part]);
    }
    for (const auto& [part, targets] : parts) read_part(*file, part, targets, window);
  });
  return loaded;
}

std::string read_attribute(const std::string& path, const std::string& name) {
  std::string value;
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    const auto* attribute = file->header(0).findTypedAttribute<Imf::StringAttribute>(name);
    if (attribute != nullptr) value = attribute->value();
  });
  return value;
}

}  // namespace becalm::io
