#include "app/additive_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "app/cancel.h"
#include "frame/error.h"
#include "frame/io/exr.h"

namespace becalm::app {
namespace {

bool can_be_read(const std::string& path, const io::LayerOptions& layers) {
  try {
    io::read_exr_header(path, layers, io::CheckChunks::no);
    return true;
  } catch (const Error& error) {
    if (error.status() == ExitStatus::resource) throw;
    return false;
  }
}

/// The first frame, perhaps a slate, that lacks the additive layers and can be read without them.
std::optional<int> frame_that_lacks(const io::LayerOptions& layers, const std::vector<NumberedFile>& files) {
  io::LayerOptions without = layers;
  without.additive.clear();
  std::vector<char> lacks(files.size(), 0);
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    stop_if_asked();
    lacks[i] = can_be_read(files[i].path, layers) || !can_be_read(files[i].path, without) ? 0 : 1;
  });
  const auto found = std::ranges::find(lacks, 1);
  if (found == lacks.end()) return std::nullopt;
  return files[static_cast<std::size_t>(found - lacks.begin())].frame;
}

/// What `auto` takes. Sets that stay noisy are told unless the user has named layers besides, perhaps theirs.
void find_sets(const std::vector<NumberedFile>& files, const io::LayerOptions& layers, bool tell_others,
               AdditiveChoice& choice) {
  std::vector<std::string> paths;
  for (const NumberedFile& file : files) paths.push_back(file.path);
  choice.sets = io::find_additive_sets(paths, layers);
  for (const io::AdditiveSet& set : choice.sets) {
    if (tell_others || set.adds_up()) choice.notes.push_back({io::describe(set), !set.adds_up()});
  }
  io::LayerOptions chosen = layers;
  chosen.additive = io::choose_additive("auto", choice.sets);
  if (chosen.additive.empty()) return;
  if (const std::optional<int> frame = frame_that_lacks(chosen, files)) {
    choice.notes = {{io::describe_lack(chosen.additive, *frame), /*is_warning=*/true}};
  } else {
    choice.layers = std::move(chosen.additive);
  }
}

}  // namespace

std::vector<NumberedFile> files_on_disk(const io::SequencePattern& pattern) {
  std::vector<NumberedFile> files;
  for (const int frame : pattern.frames_on_disk()) files.push_back({frame, pattern.path(frame)});
  return files;
}

AdditiveChoice choose_additive(const std::string& asked, const std::vector<NumberedFile>& files,
                               const io::LayerOptions& layers) {
  AdditiveChoice choice;
  const std::vector<std::string> words = io::additive_words(asked);
  const std::vector<std::string> named = io::choose_additive(asked, {});
  choice.with_usual_lights = std::ranges::find(words, "auto") != words.end();
  if (choice.with_usual_lights) find_sets(files, layers, named.empty(), choice);
  if (named.empty()) return choice;
  choice.notes.push_back({fmt::format("{} {} denoised with the beauty", fmt::join(named, ", "),
                                      named.size() == 1 ? "is" : "are"),
                          /*is_warning=*/false});
  std::ranges::copy_if(named, std::back_inserter(choice.layers), [&](const std::string& layer) {
    return std::ranges::find(choice.layers, layer) == choice.layers.end();
  });
  return choice;
}

}  // namespace becalm::app
