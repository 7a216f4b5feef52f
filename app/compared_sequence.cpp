#include "app/compared_sequence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "app/console.h"
#include "app/eye_names.h"
#include "app/noisy_image.h"
#include "frame/error.h"
#include "frame/io/exr.h"
#include "frame/io/printable.h"

namespace becalm::app {
namespace {

std::optional<Eye> eye_of(std::string_view view) {
  for (const Eye eye : {Eye::left, Eye::right}) {
    if (is_eye(view, eye)) return eye;
  }
  return std::nullopt;
}

/// The view of that name or of the same eye; the first if the name, or that of the only view, is of no eye.
std::vector<io::LoadedView*>::iterator find_like(std::vector<io::LoadedView*>& views,
                                                 const std::string& name) {
  const auto same = std::ranges::find(views, name, &io::LoadedView::view);
  if (same != views.end()) return same;
  const std::optional<Eye> eye = eye_of(name);
  if (!eye) return views.begin();
  const auto of_eye =
      std::ranges::find_if(views, [&](const io::LoadedView* view) { return eye_of(view->view) == eye; });
  const bool is_of_no_eye = views.size() == 1 && !eye_of(views.front()->view);
  return is_of_no_eye ? views.begin() : of_eye;
}

}  // namespace

ComparedSequence::ComparedSequence(const std::string& pattern, io::LayerOptions layers, std::string view)
    : pattern_(pattern), layers_(std::move(layers)), view_(std::move(view)) {}

void ComparedSequence::choose_layer(const std::vector<int>& frames) {
  std::vector<NumberedFile> files;
  files.reserve(frames.size());
  for (const int frame : frames) files.push_back({frame, pattern_.path(frame)});
  const std::optional<NoisyImage> noisy = take_noisy_image(files, layers_);
  if (!noisy) return;
  warn(fmt::format("{}: {} is denoised already: measured is {}; --layers 'beauty={}' overrules",
                   pattern_.text(), noisy->denoised, noisy->layer, noisy->denoised));
}

PlacedBeauty ComparedSequence::read(int frame) {
  return read_view(frame, "");
}

PlacedBeauty ComparedSequence::read_view(int frame, const std::string& of_reference) {
  const std::string path = pattern_.path(frame);
  io::LoadedFrame file = io::read_exr(path, frame, {}, layers_);
  std::vector<io::LoadedView*> views{&file};
  for (io::LoadedView& view : file.other_views) views.push_back(&view);
  std::vector<std::string> names;
  names.reserve(views.size());
  for (const io::LoadedView* view : views) names.push_back(io::printable(view->view));

  const auto found =
      view_.empty() ? find_like(views, of_reference) : std::ranges::find(views, view_, &io::LoadedView::view);
  if (found == views.end()) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no view '{}'{}; expected {}", path, view_.empty() ? of_reference : view_,
                            view_.empty() ? ", which the reference is of" : "",
                            views.size() == 1 && names.front().empty()
                                ? "a file of views"
                                : fmt::format("{}", fmt::join(names, " or "))));
  }
  const bool is_told = !view_.empty() || eye_of(of_reference) || (*found)->view == of_reference;
  if (!is_told && views.size() > 1 && !std::exchange(told_views_, true)) {
    warn(fmt::format("{}: measured is the view {} of {}; --view names another", path, names.front(),
                     fmt::join(names, ", ")));
  }
  io::LoadedView& view = **found;
  const Imath::V2d middle = 0.5 * Imath::V2d(view.window.min + view.window.max);
  return {path, view.view, std::move(view.frame.image(Aov::beauty)), view.window.min,
          middle + view.middle_px};
}

Image ComparedSequence::read_like(int frame, const PlacedBeauty& reference) {
  PlacedBeauty file = read_view(frame, reference.view);
  const auto place = [](const PlacedBeauty& of) {
    return fmt::format("{}x{} from pixel ({}, {}) on", of.beauty.width(), of.beauty.height(), of.first.x,
                       of.first.y);
  };
  if (file.beauty.same_shape(reference.beauty) && file.first == reference.first)
    return std::move(file.beauty);
  throw Error(ExitStatus::bad_input, fmt::format("{}: is {}, and {} is {}", file.path, place(file),
                                                 reference.path, place(reference)));
}

}  // namespace becalm::app
