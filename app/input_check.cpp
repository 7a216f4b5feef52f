#include "app/input_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "app/cancel.h"
#include "app/eye_names.h"
#include "app/frame_problems.h"
#include "filter/merge/additive.h"
#include "frame/error.h"
#include "frame/io/printable.h"

namespace becalm::app {
namespace {

/// One frame: its views' layouts, or why it has none.
struct Checked {
  int frame = 0;
  std::optional<std::vector<InputLayout>> layout;
  std::string problem;
};

void check_checkerboard(const std::string& path, bool is_checkerboard, Checkerboards checkerboards) {
  if (is_checkerboard && checkerboards == Checkerboards::refused) {
    throw Error(
        ExitStatus::bad_input,
        fmt::format("{}: a checkerboard of pixels: becalm antialias --checkerboard makes it whole first",
                    path));
  }
  if (!is_checkerboard && checkerboards == Checkerboards::as_files_tell) {
    throw Error(
        ExitStatus::bad_input,
        fmt::format("{}: does not tell which pixels of a checkerboard it holds, as becalm:checkerboard "
                    "would: expected --checkerboard=even or odd",
                    path));
  }
}

/// Of the views of one file.
std::vector<InputLayout> read_layout(const std::string& path, const FilterStage& filter,
                                     const io::LayerOptions& layers, const io::DenoisedFormat& format) {
  std::vector<InputLayout> layout;
  for (const io::ExrView& view : io::read_exr_header(path, layers, io::CheckChunks::yes)) {
    check_checkerboard(path, view.is_checkerboard, filter.checkerboards());
    layout.push_back(layout_of(view, filter));
    io::require_all_samples(path, view, layout.back().aovs,
                            filter.denoises_additive() ? io::LightGroups::read : io::LightGroups::leave);
  }
  if (!format.scale.is_one() || filter.checkerboards() != Checkerboards::refused)
    io::check_scaling(path, format.channels);
  return layout;
}

/// Of the views of one file.
std::vector<Imath::Box2i> data_windows(const std::string& path, const io::LayerOptions& layers) {
  std::vector<Imath::Box2i> windows;
  for (const io::ExrView& view : io::read_exr_header(path, layers, io::CheckChunks::no))
    windows.push_back(view.data_window);
  return windows;
}

/// The size, and the place where it is not the usual one.
std::string text_of(const Imath::Box2i& window) {
  const std::string size =
      fmt::format("{}x{}", window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
  return window.min == Imath::V2i(0) ? size : fmt::format("{} at ({}, {})", size, window.min.x, window.min.y);
}

/// Adds the layout of the right eye's file to that of the left one's.
void add_other_eye(const InputFrames& inputs, int frame, const std::vector<InputLayout>& other,
                   std::vector<InputLayout>& layout) {
  const std::string path = inputs.other_eye()->path(frame);
  if (layout.size() != 1 || other.size() != 1) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: holds several views: expected one eye a file",
                                                   other.size() > 1 ? path : inputs.path(frame)));
  }
  if (other.front().display_window != layout.front().display_window) {
    throw Error(ExitStatus::bad_input,
                fmt::format("is {}, and the right eye {} is {}", text_of(layout.front().display_window), path,
                            text_of(other.front().display_window)));
  }
  layout.push_back(other.front());
  for (std::size_t eye = 0; eye < 2; ++eye) layout[eye].view = kEyeNames[eye];
}

Checked check(const InputFrames& inputs, int frame, const FilterStage& filter, const io::LayerOptions& layers,
              const io::DenoisedFormat& format) {
  const auto read = [&](const std::string& path) { return read_layout(path, filter, layers, format); };
  try {
    std::vector<InputLayout> layout = read(inputs.path(frame));
    if (inputs.other_eye()) add_other_eye(inputs, frame, read(inputs.other_eye()->path(frame)), layout);
    if (!inputs.other_half()) return {frame, std::move(layout), ""};
    const std::string other = inputs.other_half()->path(frame);
    if (read(other) != layout || data_windows(other, layers) != data_windows(inputs.path(frame), layers)) {
      throw Error(
          ExitStatus::bad_input,
          fmt::format("{}: has not the size, windows and layers of the other half of its samples", other));
    }
    for (InputLayout& view : layout) {
      view.aovs.reset(static_cast<std::size_t>(Aov::variance));
      for (const Aov half : {Aov::half_a, Aov::half_b}) view.aovs.set(static_cast<std::size_t>(half));
    }
    return {frame, std::move(layout), ""};
  } catch (const Error& error) {
    if (error.status() == ExitStatus::resource) throw;  // no fault of the frame
    return {frame, std::nullopt, error.what()};
  }
}

/// The first frame of the layout that most frames have; of equally many, the one that comes first.
const Checked* most_common(const std::vector<Checked>& frames) {
  const auto count_like = [&](const Checked& frame) {
    return std::ranges::count_if(
        frames, [&](const Checked& other) { return other.layout && *other.layout == *frame.layout; });
  };
  const Checked* best = nullptr;
  std::ptrdiff_t best_count = 0;
  std::vector<const Checked*> kinds;
  for (const Checked& frame : frames) {
    if (!frame.layout) continue;
    if (std::ranges::any_of(kinds, [&](const Checked* kind) { return *kind->layout == *frame.layout; }))
      continue;
    kinds.push_back(&frame);
    if (const std::ptrdiff_t count = count_like(frame); count > best_count) {
      best = &frame;
      best_count = count;
    }
  }
  return best;
}

/// How a layout differs from the one that `usual` has.
std::string difference(const InputLayout& layout, const InputLayout& usual, const std::string& usual_path) {
  if (layout.display_window != usual.display_window) {
    return fmt::format("is {}, and {} is {}", text_of(layout.display_window), usual_path,
                       text_of(usual.display_window));
  }
  for (const AovInfo& entry : kAovTable) {
    if (contains(layout.aovs, entry.aov) == contains(usual.aovs, entry.aov)) continue;
    return contains(usual.aovs, entry.aov)
               ? fmt::format("has no layer '{}', which {} has", entry.name, usual_path)
               : fmt::format("has a layer '{}', which {} has not", entry.name, usual_path);
  }
  return fmt::format("has the light groups '{}', and {} has '{}'", fmt::join(layout.light_groups, ","),
                     usual_path, fmt::join(usual.light_groups, ","));
}

std::string view_names(const std::vector<InputLayout>& views) {
  std::vector<std::string> names;
  for (const InputLayout& view : views) names.push_back(io::printable(view.view));
  return fmt::format("{}", fmt::join(names, ","));
}

std::string difference(const std::vector<InputLayout>& views, const std::vector<InputLayout>& usual,
                       const std::string& usual_path) {
  if (view_names(views) != view_names(usual)) {
    return fmt::format("has the views '{}', and {} has '{}'", view_names(views), usual_path,
                       view_names(usual));
  }
  const auto [view, usual_view] = std::ranges::mismatch(views, usual);
  const std::string place = view->view.empty() ? "" : fmt::format("view {}: ", io::printable(view->view));
  return place + difference(*view, *usual_view, usual_path);
}

/// How far the data window of a view reaches beyond its display window, in pixels.
int overhang(const io::ExrView& view) {
  const Imath::V2i before = view.display_window.min - view.data_window.min;
  const Imath::V2i after = view.data_window.max - view.display_window.max;
  return std::max({0, before.x, before.y, after.x, after.y});
}

/// A view of a file, with what the header says of it.
struct PlacedView {
  std::string path;
  io::ExrView header;
};

/// Throws Error(bad_input) naming the file whose data window lies farthest off where the sequence's is too
/// large. Where none leaves its display window, these differ, as check_inputs tells.
void require_possible_window(const std::vector<std::vector<PlacedView>>& files, const Imath::Box2i& all) {
  if (all.isEmpty()) return;
  const Imath::V2i size = all.size() + Imath::V2i(1);
  if (std::max(size.x, size.y) <= io::kMaxImageSide) return;
  const PlacedView* farthest = nullptr;
  for (const auto& views : files) {
    for (const PlacedView& view : views) {
      if (farthest == nullptr || overhang(view.header) > overhang(farthest->header)) farthest = &view;
    }
  }
  if (overhang(farthest->header) == 0) return;
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: data window {}, display window {}: all frames' data windows together are "
                          "{}x{} px, expected at most {} a side",
                          farthest->path, text_of(farthest->header.data_window),
                          text_of(farthest->header.display_window), size.x, size.y, io::kMaxImageSide));
}

}  // namespace

InputLayout layout_of(const io::ExrView& header, const FilterStage& filter) {
  InputLayout layout;
  layout.view = header.view;
  layout.display_window = header.display_window;
  const AovSet additive = filter.denoises_additive() ? filter::additive_aovs() : AovSet();
  for (const AovInfo& entry : kAovTable) {
    const bool used = entry.aov == Aov::beauty || contains(filter.wanted() | additive, entry.aov);
    const auto index = static_cast<std::size_t>(entry.aov);
    layout.aovs.set(index, used && header.layers[index]);
  }
  if (filter.denoises_additive()) {
    for (const auto& [name, source] : header.lights) layout.light_groups.push_back(name);
  }
  return layout;
}

InputWindow find_window(const InputFrames& inputs, const io::LayerOptions& layers) {
  std::vector<std::string> paths;
  for (const int frame : inputs.readable()) std::ranges::move(inputs.paths(frame), std::back_inserter(paths));
  return find_window(paths, layers);
}

InputWindow find_window(const std::vector<std::string>& paths, const io::LayerOptions& layers) {
  std::vector<std::vector<PlacedView>> files(paths.size());
  tbb::parallel_for(std::size_t{0}, paths.size(), [&](std::size_t i) {
    stop_if_asked();
    try {
      for (io::ExrView& view : io::read_exr_header(paths[i], layers, io::CheckChunks::no))
        files[i].push_back({paths[i], std::move(view)});
    } catch (const Error& error) {  // told by check_inputs if the frame is needed
      if (error.status() == ExitStatus::resource) throw;
    }
  });
  Imath::Box2i all;
  bool alike = true;
  for (const auto& views : files) {
    for (const PlacedView& view : views) {
      alike = alike && (all.isEmpty() || all == view.header.data_window);
      all.extendBy(view.header.data_window);
    }
  }
  for (const auto& views : files) {
    for (const PlacedView& view : views) {
      if (!alike) all.extendBy(view.header.display_window);
    }
  }
  require_possible_window(files, all);
  return {all};
}

std::vector<InputLayout> check_inputs(const InputFrames& inputs, const std::set<int>& frames,
                                      const FilterStage& filter, const io::LayerOptions& layers,
                                      const io::DenoisedFormat& format) {
  std::vector<Checked> checked;
  for (const int frame : frames) checked.push_back({frame, std::nullopt, ""});
  tbb::parallel_for(std::size_t{0}, checked.size(), [&](std::size_t i) {
    stop_if_asked();
    checked[i] = check(inputs, checked[i].frame, filter, layers, format);
  });

  const Checked* usual = most_common(checked);
  FrameProblems problems(inputs.pattern(), usual_step({frames.begin(), frames.end()}));
  for (const Checked& frame : checked) {
    if (frame.layout && *frame.layout == *usual->layout) continue;
    problems.add(frame.frame, frame.layout
                                  ? difference(*frame.layout, *usual->layout, inputs.path(usual->frame))
                                  : frame.problem);
  }
  if (!problems.empty()) problems.fail(checked.size(), "; nothing was written");
  return *usual->layout;
}

}  // namespace becalm::app
