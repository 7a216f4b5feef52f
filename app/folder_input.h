#pragma once

#include <string>

namespace becalm::app {

/// Throws Error(usage) where the path of an input is a folder, naming the sequences in it.
void refuse_folder(const std::string& path);

}  // namespace becalm::app
