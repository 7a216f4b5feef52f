#pragma once

#include <string>
#include <vector>

#include "frame/io/additive_layers.h"
#include "frame/io/layers.h"
#include "frame/io/sequence.h"

namespace becalm::app {

/// A file of a sequence, or of one of its eyes or halves.
struct NumberedFile {
  int frame = 0;
  std::string path;
};

/// The files of all frames on disk.
std::vector<NumberedFile> files_on_disk(const io::SequencePattern& pattern);

/// What a user is told of layers that may be summands of the beauty.
struct AdditiveNote {
  std::string text;
  bool is_warning;  ///< they stay noisy
};

/// Which layers are denoised with the beauty.
struct AdditiveChoice {
  std::vector<std::string> layers;
  bool with_usual_lights = true;  ///< as io::LayerOptions has it
  std::vector<AdditiveNote> notes;
  std::vector<io::AdditiveSet> sets;  ///< that were found
};

/// `asked` is `--additive auto|none|NAME,NAME|auto,NAME`. Auto chooses by all files of a sequence, so that
/// all jobs of it choose alike: what adds up in the first frame that tells, if every file has it. A damaged
/// file says nothing. Without the word auto only the named layers are taken.
AdditiveChoice choose_additive(const std::string& asked, const std::vector<NumberedFile>& files,
                               const io::LayerOptions& layers);

}  // namespace becalm::app
