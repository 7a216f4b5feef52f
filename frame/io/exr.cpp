#include "frame/io/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "frame/error.h"
#include "frame/io/exr_file.h"
#include "frame/io/exr_parts.h"
#include "frame/io/jitter_text.h"
#include "frame/io/printable.h"
#include "frame/io/read_error.h"
#include "frame/io/samples.h"
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

/// What is read of a part.
struct PartTargets {
  TargetsByChannel channels;
  std::set<std::string> denoised;  ///< channels that the denoised frame replaces
};

/// More than this is not kept of a file: frames are read again rather than that memory is full of them.
constexpr std::size_t kLargestKept = std::size_t{256} << 20;

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

/// Copies what the lines first..last of the plane and the frame's window have in common.
void copy_lines(const Stripe::Plane& plane, const Imath::Box2i& lines, int first, int last,
                const Target& target) {
  const Imath::Box2i& frame_window = target.window;
  const int begin = std::max(lines.min.x, frame_window.min.x);
  const int end = std::min(lines.max.x, frame_window.max.x) + 1;
  if (begin >= end) return;
  std::vector<float> values(static_cast<std::size_t>(end - begin));
  for (int y = std::max(first, frame_window.min.y); y <= std::min(last, frame_window.max.y); ++y) {
    const std::size_t row = static_cast<std::size_t>(y - lines.min.y) * width_of(lines);
    from_samples(plane.type, &plane.bytes[(row + (begin - lines.min.x)) * size_of(plane.type)], values);
    if (target.squared) std::ranges::transform(values, values, values.begin(), std::multiplies<>());
    float* to = &target.image->at(begin - frame_window.min.x, y - frame_window.min.y, target.channel);
    const int channels = target.image->channels();
    for (std::size_t x = 0; x < values.size(); ++x) to[x * channels] = values[x] * target.scale;
  }
}

void copy_to_targets(const Stripe& stripe, int first, int last, const TargetsByChannel& targets) {
  for (const Stripe::Plane& plane : stripe.planes()) {
    const auto found = targets.find(plane.channel);
    if (found == targets.end()) continue;
    for (const Target& target : found->second) copy_lines(plane, stripe.lines(), first, last, target);
  }
}

/// The channels of a part that are passed on, with room for all of its lines.
Stripe passed_on_channels(const Imf::Header& header, const PartTargets& targets) {
  Stripe stripe(header.dataWindow());
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    const Imf::Channel& channel = it.channel();
    if (targets.denoised.contains(it.name())) continue;
    stripe.add(it.name(), channel.type, channel.xSampling, channel.ySampling);
  }
  return stripe;
}

/// Bytes of the stripe's planes when it holds all lines of the window.
std::size_t bytes_in(const Stripe& stripe, const Imath::Box2i& window) {
  std::size_t bytes = 0;
  for (const Stripe::Plane& plane : stripe.planes()) {
    bytes += stripe.row_bytes(plane) * static_cast<std::size_t>(height_of(window));
  }
  return bytes;
}

/// Reads a part's targets, and into `kept` its channels.
void read_part(Imf::MultiPartInputFile& file, int part_number, const TargetsByChannel& targets,
               Stripe& kept) {
  Imf::InputPart part(file, part_number);
  const Imath::Box2i window = part.header().dataWindow();
  kept.move_to(window.min.y, window.max.y);
  Stripe stripe(window);
  for (const auto& entry : targets) {
    if (kept.plane_of(entry.first) == nullptr) stripe.add(entry.first, Imf::FLOAT);
  }
  const auto all = [](const Stripe::Plane&) { return true; };
  for_each_stripe(part.header(), [&](int first, int last) {
    stripe.move_to(first, last);
    Imf::FrameBuffer buffer = stripe.frame_buffer(all);
    const Imf::FrameBuffer of_kept = kept.frame_buffer(all);
    for (auto slice = of_kept.begin(); slice != of_kept.end(); ++slice) {
      buffer.insert(slice.name(), slice.slice());
    }
    part.setFrameBuffer(buffer);
    part.readPixels(first, last);
    copy_to_targets(stripe, first, last, targets);
    copy_to_targets(kept, first, last, targets);
  });
}

/// As LoadedView::rounding has it.
float rounding_of(const Imf::MultiPartInputFile& file, const LayerSource& source) {
  constexpr float half_step = 0x1p-25f;
  float largest = 0.0f;
  for (std::size_t c = 0; c < source.channels.size(); ++c) {
    const Imf::Channel* channel = file.header(source.part).channels().findChannel(source.channels[c]);
    if (channel == nullptr || channel->type != Imf::HALF) continue;
    largest =
        std::max(largest, std::abs(source.scale[c]) * (source.squared ? half_step * half_step : half_step));
  }
  return largest;
}

/// Makes the images of a view, and notes for each part what is to be read into them. `parts` points into the
/// view afterwards, so it must not move.
void add_targets(const Imf::MultiPartInputFile& file, AovSet wanted, LightGroups light_groups,
                 LoadedView& view, std::map<int, PartTargets>& parts) {
  const auto add = [&](const LayerSource& source, Image& image, float nothing, bool denoised) {
    const Imath::Box2i& read = file.header(source.part).dataWindow();
    const bool is_all_read = read.intersects(view.window.min) && read.intersects(view.window.max);
    if (!is_all_read) std::ranges::fill(image.data(), nothing);
    for (std::size_t c = 0; c < source.channels.size(); ++c) {
      if (source.channels[c].empty()) {  // a beauty without alpha is opaque
        for (std::size_t i = c; i < image.data().size(); i += source.channels.size()) image.data()[i] = 1.0f;
        continue;
      }
      PartTargets& part = parts[source.part];
      part.channels[source.channels[c]].push_back(
          {&image, view.window, static_cast<int>(c), source.scale[c], source.squared});
      if (denoised) part.denoised.insert(source.channels[c]);
    }
  };
  for (const AovInfo& entry : kAovTable) {
    const std::size_t index = static_cast<std::size_t>(entry.aov);
    if (!wanted.test(index) || !view.layers[index]) continue;
    add(*view.layers[index], view.frame.add(entry.aov, Unfilled{}), value_of_nothing(entry.aov),
        is_denoised(entry.aov));
  }
  if (light_groups == LightGroups::leave) return;
  std::vector<LightGroup>& groups = view.frame.light_groups();
  const auto image = [&] { return Image(view.frame.width(), view.frame.height(), 3, Unfilled{}); };
  for (const auto& [name, source] : view.lights) groups.push_back({name, image()});
  for (LightGroup& group : groups) {
    const LightSource& source = view.lights.at(group.name);
    add(source.layer, group.radiance, 0.0f, true);
    if (source.colour) add(*source.colour, view.colours[group.name] = image(), 0.0f, false);
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

/// Makes radiance beyond a view's own data window NaN, so that filters do not take it for black; but only
/// where the nearest pixel is opaque: renderers crop what is empty.
void forget_outside(const Imath::Box2i& data_window, LoadedView& view) {
  if (data_window == view.window) return;
  Image& beauty = view.frame.image(Aov::beauty);
  const Imath::Box2i inside(data_window.min - view.window.min, data_window.max - view.window.min);
  std::size_t unknown = 0;
  for (int y = 0; y < beauty.height(); ++y) {
    for (int x = 0; x < beauty.width(); ++x) {
      const Imath::V2i nearest(std::clamp(x, inside.min.x, inside.max.x),
                               std::clamp(y, inside.min.y, inside.max.y));
      if (nearest == Imath::V2i(x, y) || beauty.at(nearest.x, nearest.y, 3) < 1.0f) continue;
      std::ranges::fill(beauty.pixel(x, y).first(3), std::numeric_limits<float>::quiet_NaN());
      ++unknown;
    }
  }
  if (unknown > 0) view.frame.set_cut(Cut{inside, unknown});
}

std::string corners_of(const Imath::Box2i& window) {
  return fmt::format("({}, {}) to ({}, {})", window.min.x, window.min.y, window.max.x, window.max.y);
}

/// The views of the file, each with the windows of its beauty's part.
std::vector<ExrView> views_of(const std::string& path, const Imf::MultiPartInputFile& file,
                              const LayerOptions& options) {
  require_flat(path, file);
  std::vector<std::string> names(static_cast<std::size_t>(file.parts()));
  for (int part = 0; file.parts() > 1 && part < file.parts(); ++part) {
    if (file.header(part).hasName())
      names[static_cast<std::size_t>(part)] = printable(file.header(part).name());
  }
  std::vector<ExrView> views;
  for (ViewLayers& found : find_view_layers(path, part_channels(file), options)) {
    const Imf::Header& header = file.header(found.layers[static_cast<std::size_t>(Aov::beauty)]->part);
    views.push_back(
        {std::move(found), header.dataWindow(), header.displayWindow(), names, is_checkerboard(file)});
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

void require_all_samples(const std::string& path, const ViewLayers& view, AovSet aovs, LightGroups lights) {
  const auto require = [&](const LayerSource& source, std::string_view what, const std::string& remedy) {
    if (!source.subsampled) return;
    std::vector<std::string> channels = source.channels;
    std::erase(channels, "");
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: {} of {} has fewer samples than pixels, expected one in each{}", path,
                            printable(what), printable(fmt::format("{}", fmt::join(channels, ","))), remedy));
  };
  for (const AovInfo& entry : kAovTable) {
    const std::optional<LayerSource>& source = view.layers[static_cast<std::size_t>(entry.aov)];
    if (!source) continue;
    if (entry.aov == Aov::beauty) {
      require(*source, "beauty", "");
    } else if (contains(aovs, entry.aov)) {
      require(*source, entry.name, fmt::format("; --layers {}=none leaves it out", entry.name));
    }
  }
  if (lights == LightGroups::leave) return;
  for (const auto& [name, light] : view.lights) {
    const std::string remedy = "; --additive none passes light groups on";
    require(light.layer, name, remedy);
    if (light.colour) require(*light.colour, name, remedy);
  }
}

bool has_all_chunks(const std::string& path) {
  try {
    reading(path, [&] {
      stamp_of(path);
      require_all_chunks(path, *open_exr(path));
    });
    return true;
  } catch (const ReadError&) {
    throw;
  } catch (const Error& error) {
    if (error.status() != ExitStatus::bad_input) throw;
    return false;
  }
}

LoadedFrame read_exr(const std::string& path, int frame_number, AovSet wanted, const LayerOptions& options,
                     LightGroups light_groups, const std::optional<Imath::Box2i>& window, KeepPassedOn keep) {
  LoadedFrame loaded;
  reading(path, [&] {
    const auto contents = std::make_shared<ExrContents>(path, stamp_of(path));
    loaded.contents = contents;
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    const std::vector<ExrView> views = views_of(path, *file, options);
    require_all_chunks(path, *file);

    for (const ExrView& view : views) require_all_samples(path, view, wanted, light_groups);
    wanted.set(static_cast<std::size_t>(Aov::beauty));
    loaded.other_views.resize(views.size() - 1);
    std::map<int, PartTargets> parts;
    for (std::size_t i = 0; i < views.size(); ++i) {
      LoadedView& view = i == 0 ? loaded : loaded.other_views[i - 1];
      static_cast<ViewLayers&>(view) = views[i];
      view.window = window.value_or(views[i].data_window);
      if (!view.window.intersects(views[i].data_window)) {
        throw Error(ExitStatus::bad_input,
                    fmt::format("{}: data window {}: expected one that overlaps the sequence's, {}", path,
                                corners_of(views[i].data_window), corners_of(view.window)));
      }
      std::ranges::transform(view.layers, view.rounding.begin(),
                             [&](const auto& source) { return source ? rounding_of(*file, *source) : 0.0f; });
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
      add_targets(*file, wanted, light_groups, view, parts);
    }
    std::size_t room = keep == KeepPassedOn::yes ? kLargestKept : 0;
    for (const auto& [number, targets] : parts) {
      const Imf::Header& header = file->header(number);
      Stripe kept(header.dataWindow());
      // A part without denoised channels is copied as it is.
      if (room > 0 && !targets.denoised.empty()) {
        Stripe wanted_by_writer = passed_on_channels(header, targets);
        const std::size_t bytes = bytes_in(wanted_by_writer, header.dataWindow());
        if (bytes <= room) {
          room -= bytes;
          kept = std::move(wanted_by_writer);
        }
      }
      read_part(*file, number, targets.channels, kept);
      if (!kept.planes().empty()) contents->keep(number, std::move(kept));
    }
    multiply_by_colours(loaded);
    std::ranges::for_each(loaded.other_views, multiply_by_colours);
    for (std::size_t i = 0; i < views.size(); ++i)
      forget_outside(views[i].data_window, i == 0 ? loaded : loaded.other_views[i - 1]);
  });
  return loaded;
}

std::map<std::string, std::string> read_attributes(const std::string& path) {
  std::map<std::string, std::string> texts;
  reading(path, [&] {
    stamp_of(path);
    const std::unique_ptr<Imf::MultiPartInputFile> file = open_exr(path);
    const Imf::Header& header = file->header(0);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
      const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
      if (text != nullptr) texts[attribute.name()] = text->value();
    }
  });
  return texts;
}

std::string read_attribute(const std::string& path, const std::string& name) {
  return read_attributes(path)[name];
}

}  // namespace becalm::io
