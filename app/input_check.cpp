#include "app/input_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "app/frame_problems.h"
#include "filter/additive.h"
#include "frame/error.h"

namespace becalm::app {
namespace {

/// One frame: its layout, or why it has none.
struct Checked {
  int frame = 0;
  std::optional<InputLayout> layout;
  std::string problem;
};

bool same_layout(const InputLayout& a, const InputLayout& b) {
  return a.display_window == b.display_window && a.aovs == b.aovs && a.light_groups == b.light_groups;
}

Checked check(const InputFrames& inputs, int frame, const FilterStep& filter,
              const io::LayerOverrides& overrides) {
  try {
    return {frame,
            layout_of(io::read_exr_header(inputs.path(frame), overrides, io::CheckChunks::yes), filter), ""};
  } catch (const Error& error) {
    return {frame, std::nullopt, error.what()};
  }
}

/// The first frame of the layout that most frames have; of equally many, the one that comes first.
const Checked* most_common(const std::vector<Checked>& frames) {
  const auto count_like = [&](const Checked& frame) {
    return std::ranges::count_if(frames, [&](const Checked& other) {
      return other.layout && same_layout(*other.layout, *frame.layout);
    });
  };
  const Checked* best = nullptr;
  std::ptrdiff_t best_count = 0;
  std::vector<const Checked*> kinds;
  for (const Checked& frame : frames) {
    if (!frame.layout) continue;
    if (std::ranges::any_of(kinds,
                            [&](const Checked* kind) { return same_layout(*kind->layout, *frame.layout); }))
      continue;
    kinds.push_back(&frame);
    if (const std::ptrdiff_t count = count_like(frame); count > best_count) {
      best = &frame;
      best_count = count;
    }
  }
  return best;
}

/// The size, and the place where it is not the usual one.
std::string text_of(const Imath::Box2i& window) {
  const std::string size =
      fmt::format("{}x{}", window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
  return window.min == Imath::V2i(0) ? size : fmt::format("{} at ({}, {})", size, window.min.x, window.min.y);
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

}  // namespace

InputLayout layout_of(const io::ExrHeader& header, const FilterStep& filter) {
  InputLayout layout;
  layout.display_window = header.display_window;
  const auto source = [&](Aov aov) -> const auto& {
    return header.layers[static_cast<std::size_t>(aov)];
  };
  const AovSet additive = filter.denoises_additive() ? filter::additive_aovs() : AovSet();
  for (const AovInfo& entry : kAovTable) {
    const bool used = entry.aov == Aov::beauty || contains(filter.wanted(), entry.aov) ||
                      (contains(additive, entry.aov) && source(entry.aov) &&
                       source(entry.aov)->part == source(Aov::beauty)->part);
    layout.aovs.set(static_cast<std::size_t>(entry.aov), used && source(entry.aov));
  }
  if (filter.denoises_additive()) layout.light_groups = header.light_groups;
  return layout;
}

InputWindow find_window(const InputFrames& inputs, const io::LayerOverrides& overrides) {
  const std::vector<int>& frames = inputs.readable();
  std::vector<std::optional<io::ExrHeader>> headers(frames.size());
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    try {
      headers[i] = io::read_exr_header(inputs.path(frames[i]), overrides, io::CheckChunks::no);
    } catch (const Error&) {  // told by check_inputs if the frame is needed
    }
  });
  Imath::Box2i all;
  bool alike = true;
  for (const auto& header : headers) {
    if (!header) continue;
    alike = alike && (all.isEmpty() || all == header->data_window);
    all.extendBy(header->data_window);
  }
  for (const auto& header : headers) {
    if (header && !alike) all.extendBy(header->display_window);
  }
  return {all};
}

InputLayout check_inputs(const InputFrames& inputs, const std::set<int>& frames, const FilterStep& filter,
                         const io::LayerOverrides& overrides) {
  std::vector<Checked> checked;
  for (const int frame : frames) checked.push_back({frame, std::nullopt, ""});
  tbb::parallel_for(std::size_t{0}, checked.size(),
                    [&](std::size_t i) { checked[i] = check(inputs, checked[i].frame, filter, overrides); });

  const Checked* usual = most_common(checked);
  FrameProblems problems(inputs.pattern());
  for (const Checked& frame : checked) {
    if (frame.layout && same_layout(*frame.layout, *usual->layout)) continue;
    problems.add(frame.frame, frame.layout
                                  ? difference(*frame.layout, *usual->layout, inputs.path(usual->frame))
                                  : frame.problem);
  }
  if (!problems.empty()) problems.fail(checked.size(), "; nothing was written");
  return *usual->layout;
}

}  // namespace becalm::app
