#pragma once

#include <string>
#include <vector>

namespace becalm::app {

/// A word as a POSIX shell reads it, in quotes where it needs them.
std::string shell_word(const std::string& word);
/// A command as one would type it.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace becalm::app
