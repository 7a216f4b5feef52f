#include "app/fingerprints.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for_each.h>

#include <filesystem>

#include "app/cancel.h"
#include "app/content_hash.h"
#include "frame/io/frame_range.h"

namespace becalm::app {
namespace {

constexpr const char* kInputs = "becalm:inputs";

}  // namespace

std::string layers_text(const io::ExrView& view, AovSet used) {
  std::string text;
  for (const AovInfo& entry : kAovTable) {
    if (!contains(used, entry.aov)) continue;
    const io::LayerSource& source = *view.layers[static_cast<std::size_t>(entry.aov)];
    const std::string& part = view.part_names[static_cast<std::size_t>(source.part)];
    text += fmt::format("{}{}={}{}{}", text.empty() ? "" : " ", entry.name.empty() ? "beauty" : entry.name,
                        part, part.empty() ? "" : "/", fmt::join(source.channels, ","));
  }
  return text;
}

void Fingerprints::take(int frame) {
  taken(frame);
}

io::Attributes Fingerprints::of(int frame) {
  ContentHash hash;
  hash.add(static_cast<std::uint64_t>(frame));
  for (const int side : {window_.window.min.x, window_.window.min.y, window_.width(), window_.height()}) {
    hash.add(static_cast<std::uint64_t>(side));
  }
  const std::set<int> frames = read_for(frame);
  for (const int read : frames) {
    hash.add(static_cast<std::uint64_t>(read));
    hash.add(taken(read).hash);
  }
  const Taken& own = taken(frame);
  io::Attributes attributes{
      {kInputs, fmt::format("{} {}", io::format_frame_range({frames.begin(), frames.end()}), hash.text())},
      {kLayersAttribute, own.layers}};
  if (!own.settings.empty()) attributes.emplace_back("becalm:input_settings", own.settings);
  return attributes;
}

std::set<int> Fingerprints::up_to_date(const std::set<int>& existing,
                                       const std::function<std::vector<std::string>(int)>& paths) {
  std::set<int> read;
  std::map<int, int> sources;  // of the outputs
  for (const int source : inputs_.sources()) {
    for (const int output : inputs_.outputs_of(source)) {
      if (!existing.contains(output)) continue;
      sources[output] = source;
      read.merge(read_for(source));
    }
  }
  tbb::parallel_for_each(read, [this](int frame) {
    stop_if_asked();
    take(frame);
  });
  std::set<int> same;
  for (const auto& [output, source] : sources) {
    const std::string inputs = of(source).front().second;
    if (std::ranges::all_of(paths(output), [&](const std::string& path) {
          return io::read_attribute(path, kInputs) == inputs;
        })) {
      same.insert(output);
    }
  }
  return same;
}

const Fingerprints::Taken& Fingerprints::taken(int frame) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = taken_.find(frame); known != taken_.end()) return known->second;
  }
  const std::string path = inputs_.path(frame);
  Taken taken;
  taken.settings = io::read_attribute(path, "becalm:settings");
  for (const io::ExrView& view : io::read_exr_header(path, layers_, io::CheckChunks::no)) {
    const std::string layers = layers_text(view, layout_of(view, filter_).aovs);
    taken.layers += fmt::format("{}{}{}{}", taken.layers.empty() ? "" : " ", view.view,
                                view.view.empty() ? "" : ": ", layers);
  }
  if (inputs_.other_half()) taken.layers += " with the other half of the samples beside it";
  ContentHash hash;
  hash.add(taken.layers);
  for (const std::string& file : inputs_.paths(frame)) {
    std::error_code error;
    hash.add(std::filesystem::file_size(file, error));
    hash.add_file(file);
  }
  taken.hash = hash.value();
  const std::lock_guard lock(mutex_);
  return taken_.emplace(frame, std::move(taken)).first->second;
}

std::set<int> Fingerprints::read_for(int frame) const {
  std::set<int> frames;
  for (const filter::Segment& segment : filter_.schedule(inputs_.readable(), {frame}, inputs_.step())) {
    for (const filter::Step& step : segment) frames.insert(step.frame);
  }
  return frames;
}

}  // namespace becalm::app
