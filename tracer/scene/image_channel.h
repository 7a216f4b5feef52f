#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace becalm::tracer {

/// Opens an image file with its colours as they are beside their alpha: multiplied by it, the edges of
/// cut-out leaves would be dark. Null if it cannot; OIIO::geterror() says why.
inline std::unique_ptr<OIIO::ImageInput> open_image(const std::string& path) {
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  return OIIO::ImageInput::open(path, &config);
}

/// Throws std::runtime_error for what is not one picture of flat pixels: reading it would give more than its
/// width times its height.
inline void require_flat(const OIIO::ImageSpec& spec) {
  if (spec.depth > 1 || spec.deep || spec.width < 1 || spec.height < 1)
    throw std::runtime_error("it is a volume or has deep pixels, expected a flat image");
}

/// As open_image and require_flat; also throws std::runtime_error with the reason for what cannot be opened.
inline std::unique_ptr<OIIO::ImageInput> open_flat_image(const std::string& path) {
  std::unique_ptr<OIIO::ImageInput> file = open_image(path);
  if (!file) throw std::runtime_error(OIIO::geterror());
  require_flat(file->spec());
  return file;
}

/// Whether the file has three colours; grey otherwise, with or without alpha.
inline bool has_colors(const OIIO::ImageSpec& spec) {
  return spec.nchannels >= 3;
}

/// The file's channel that is `name` ("r", "g", "b" or "a"); -1 if there is none. Grey serves as r, g and b.
inline int find_channel(const OIIO::ImageSpec& spec, std::string_view name) {
  if (name == "a") return spec.alpha_channel;
  return has_colors(spec) ? static_cast<int>(std::string_view("rgb").find(name)) : 0;
}

/// As find_channel. Throws std::runtime_error if there is none.
inline int require_channel(const OIIO::ImageSpec& spec, std::string_view name) {
  const int channel = find_channel(spec, name);
  if (channel < 0) throw std::runtime_error("it has no channel '" + std::string(name) + "'");
  return channel;
}

}  // namespace becalm::tracer
