#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "frame/pictures/pictures.h"

namespace becalm::tracer {

/// Whether the file has three colours; grey otherwise, with or without alpha.
inline bool has_colors(const pictures::Header& header) {
  return header.channels >= 3;
}

/// The file's channel that is `name` ("r", "g", "b" or "a"); -1 if there is none. Grey serves as r, g and b.
inline int find_channel(const pictures::Header& header, std::string_view name) {
  return pictures::find_channel(header.channels, header.alpha_channel, name);
}

/// As find_channel. Throws std::runtime_error if there is none.
inline int require_channel(const pictures::Header& header, std::string_view name) {
  const int channel = find_channel(header, name);
  if (channel < 0) throw std::runtime_error("it has no channel '" + std::string(name) + "'");
  return channel;
}

}  // namespace becalm::tracer
