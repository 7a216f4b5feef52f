#include "frame/io/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <map>

#include "frame/error.h"
#include "frame/io/exr_file.h"
#include "frame/io/jitter_text.h"
#include "frame/io/stereo_text.h"
#include "frame/io/stripe.h"

namespace becalm::io {
namespace {

/// One channel of a frame's image that a file's channel is read into.
struct Target {
  Image* image;
  Imath::Box2i window;  ///< of the frame
  int channel;
  float scale = 1.0f;
  bool squared = false;
};

using TargetsByChannel = std::map<std::string, std::vector<Target>>;

int width_of(const Imath::Box2i& window) {
  return window.max.x - window.min.x + 1;
}
Imath::V2d middle_of(const Imath::Box2i& window) {
  return {0.5 * (window.min.x + window.max.x), 0.5 * (window.min.y + window.max.y)};
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
void copy_lines(const Stripe::Plane& plane, const Imath::Box2i& lines, const Target& target) {
  const Imath::Box2i& frame_window = target.window;
  const int x_begin = std::max(lines.min.x, frame_window.min.x);
  const int x_end = std::min(lines.max.x, frame_window.max.x) + 1;
  for (int y = std::max(lines.min.y, frame_window.min.y); y <= std::min(lines.max.y, frame_window.max.y);
       ++y) {
    const std::size_t row = static_cast<std::size_t>(y - lines.min.y) * width_of(lines);
    for (int x = x_begin; x < x_end; ++x) {
      float value;
      std::memcpy(&value, &plane.bytes[(row + (x - lines.min.x)) * sizeof value], sizeof value);
      if (target.squared) value *= value;
      target.image->at(x - frame_window.min.x, y - frame_window.min.y, target.channel) = value * target.scale;
    }
  }
}

void read_part(Imf::MultiPartInputFile& file, int part_number, const TargetsByChannel& targets) {
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
      for (const Target& target : targets.at(plane.channel)) copy_lines(plane, lines, target);
    }
  });
}

/// Makes the images of a view, and notes for each part what is to be read into them. `parts` points into the
/// view afterwards, so it must not move.
void add_targets(AovSet wanted, LightGroups light_groups, LoadedView& view,
                 std::map<int, TargetsByChannel>& parts) {
  const auto add = [&](const LayerSource& source, Image& image) {
    for (std::size_t c = 0; c < source.channels.size(); ++c) {
      if (source.channels[c].empty()) {  // a beauty without alpha is opaque
        for (std::size_t i = c; i < image.data().size(); i += source.channels.size()) image.data()[i] = 1.0f;
        continue;
      }
      parts[source.part][source.channels[c]].push_back(
          {&image, view.window, static_cast<int>(c), source.scale[c], source.squared});
    }
  };
  for (const AovInfo& entry : kAovTable) {
    const std::size_t index = static_cast<std::size_t>(entry.aov);
    if (!wanted.test(index) || !view.layers[index]) continue;
    add(*view.layers[index], view.frame.add(entry.aov, value_of_nothing(entry.aov)));
  }
  if (light_groups == LightGroups::leave) return;
  std::vector<LightGroup>& groups = view.frame.light_groups();
  for (const auto& [name, source] : view.lights) {
    groups.push_back({name, Image(view.frame.width(), view.frame.height(), 3)});
  }
  for (LightGroup& group : groups) {
    const LightSource& source = view.lights.at(group.name);
    add(source.layer, group.radiance);
    if (!source.colour) continue;
    Image& colour = view.colours[group.name] = Image(view.frame.width(), view.frame.height(), 3);
    add(*source.colour, colour);
  }
}

void multiply_by_colours(LoadedView& view) {
  for (LightGroup& group : view.frame.light_groups()) {
    const auto colour = view.colours.find(group.name);
    if (colour == view.colours.end()) continue;
    std::ranges::transform(group.radiance.data(), colour->second.data(), group.radiance.data().begin(),
                           std::multiplies<>());
  }
}

void require_flat(const std::string& path, const Imf::MultiPartInputFile& file) {
  for (int part = 0; part < file.parts(); ++part) {
    if (!is_deep(file.header(part))) return;
  }
  throw Error(ExitStatus::bad_input, fmt::format("{}: a deep image, expected flat pixels", path));
}

/// Empty where there is none.
std::string text_attribute(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute == nullptr ? std::string() : attribute->value();
}

/// The views of the file, each with the windows of its beauty's part.
std::vector<ExrView> views_of(const std::string& path, const Imf::MultiPartInputFile& file,
                              const LayerOptions& options) {
  require_flat(path, file);
  std::vector<ExrView> views;
  for (ViewLayers& found : find_view_layers(path, part_channels(file), options)) {
    const Imf::Header& header = file.header(found.layers[static_cast<std::size_t>(Aov::beauty)]->part);
    const bool is_checkerboard =
        parse_checkerboard(text_attribute(file.header(0), kCheckerboardAttribute), {}).has_value();
    views.push_back({std::move(found), header.dataWindow(), header.displayWindow(), is_checkerboard});
  }
  return views;
}

}  // namespace

std::vector<ExrView> read_exr_header(const std::string& path, const LayerOptions& options,
                                     CheckChunks check_chunks) {
  std::vector<ExrView> views;
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    views = views_of(path, *file, options);
    if (check_chunks == CheckChunks::yes) require_all_chunks(path, *file);
  });
  return views;
}

LoadedFrame read_exr(const std::string& path, int frame_number, AovSet wanted, const LayerOptions& options,
                     LightGroups light_groups, const std::optional<Imath::Box2i>& window) {
  LoadedFrame loaded;
  reading(path, [&] {
    loaded.contents = std::make_shared<ExrContents>(path, stamp_of(path));
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    const std::vector<ExrView> views = views_of(path, *file, options);
    require_all_chunks(path, *file);

    wanted.set(static_cast<std::size_t>(Aov::beauty));
    loaded.other_views.resize(views.size() - 1);
    std::map<int, TargetsByChannel> parts;
    for (std::size_t i = 0; i < views.size(); ++i) {
      LoadedView& view = i == 0 ? loaded : loaded.other_views[i - 1];
      static_cast<ViewLayers&>(view) = views[i];
      view.window = window.value_or(views[i].data_window);
      view.frame = Frame(frame_number, width_of(view.window), height_of(view.window));
      // As the file records them; nothing where it does not, or in words that becalm does not know.
      view.frame.set_jitter(parse_jitter(text_attribute(file->header(0), kJitterAttribute)));
      view.frame.set_checkerboard(
          parse_checkerboard(text_attribute(file->header(0), kCheckerboardAttribute), view.window.min));
      const int part = view.layers[static_cast<std::size_t>(Aov::beauty)]->part;
      std::optional<StereoView> stereo = parse_stereo(text_attribute(file->header(part), kStereoAttribute));
      view.middle_px = middle_of(views[i].display_window) - middle_of(view.window);
      if (stereo) stereo->middle_px = view.middle_px;
      view.frame.set_stereo(stereo);
      add_targets(wanted, light_groups, view, parts);
    }
    for (const auto& [part, targets] : parts) read_part(*file, part, targets);
    multiply_by_colours(loaded);
    std::ranges::for_each(loaded.other_views, multiply_by_colours);
  });
  return loaded;
}

std::string read_attribute(const std::string& path, const std::string& name) {
  std::string value;
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    value = text_attribute(file->header(0), name.c_str());
  });
  return value;
}

}  // namespace becalm::io
