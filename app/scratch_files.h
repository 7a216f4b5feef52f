#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/outputs.h"
#include "frame/stereo.h"

namespace becalm::app {

/// Where noisy frames wait for the filter: in --keep-noisy, or if that is empty beside the outputs, under a
/// name that nobody gives to frames that are kept. That name has a frame field even if the output, being one
/// frame, has none: the filter reads its neighbours, too. It tells the frames asked for, so that jobs that
/// read each other's frames have files of their own. `first` is the first eye of a pattern with a field for
/// it.
std::string noisy_pattern(const std::string& keep_noisy, const std::string& output, Eye first,
                          const std::vector<int>& asked);

/// Removes a file that nothing reads any more. If that fails, a warning for the user.
std::optional<std::string> remove_scratch_file(const std::string& path);

/// Removes scratch files that runs for other frames have left. A file's name tells the first and the last
/// frame of its run; if this run has locked the output of one of the two, that run has ended, and the file is
/// removed. Other runs' files stay. `readable` are the frames that may have such files.
void remove_abandoned_scratch(const std::string& output, Eye first, const Outputs& locked,
                              const std::vector<int>& readable);

}  // namespace becalm::app
