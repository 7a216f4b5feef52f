#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "app/profile.h"
#include "app/progress.h"
#include "frame/error.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// One line if values did not fit into half; `remedy` says what would keep them.
void warn_overflows(Progress& progress, int frame, const io::WriteReport& report, std::string_view remedy);

/// One line for each file that --resume found damaged and that is therefore written again.
void warn_unusable(const std::vector<std::string>& paths);

/// --resume with nothing left to do.
ExitStatus all_there(std::size_t frames, bool quiet);

/// The last words of a command that writes frames, and its status: done, or interrupted and how to go on.
ExitStatus conclude(Progress& progress, std::size_t frames_asked, const Profile* profile);

}  // namespace becalm::app
