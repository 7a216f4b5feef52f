#pragma once

#include <cstddef>
#include <span>

namespace becalm {

/// Loads a shared library from bytes that the executable holds, through an anonymous file, and returns the
/// address of its function `entry`. `library` names in messages what it brings. Throws Error(resource).
void* load_embedded_library(std::span<const std::byte> bytes, const char* entry, const char* library);

}  // namespace becalm
