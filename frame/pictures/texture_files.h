#pragma once

#include <memory>
#include <string>

#include <OpenImageIO/imageio.h>

#include "frame/pictures/pictures.h"

namespace becalm::pictures {

/// Opens an image file with its colours as they are beside their alpha: multiplied by it, the edges of
/// cut-out leaves would be dark. Null if it cannot; OIIO::geterror() says why.
std::unique_ptr<OIIO::ImageInput> open_separate(const std::string& path);

std::unique_ptr<TextureFiles> make_texture_files();

}  // namespace becalm::pictures
