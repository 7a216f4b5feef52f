#include "frame/pictures/pictures.h"

#include <cstddef>

#include "frame/pictures/embedded_library.h"

extern "C" {
// NOLINTBEGIN(readability-identifier-naming): symbols of becalm_embed_module
extern const std::byte becalm_pictures_module[];
extern const std::byte becalm_pictures_module_end[];
// NOLINTEND(readability-identifier-naming)
}

namespace becalm::pictures {

Library& library() {
  static Library& loaded = *reinterpret_cast<Library* (*)()>(load_embedded_library(
      {becalm_pictures_module, becalm_pictures_module_end}, "becalm_pictures_library", "OpenImageIO"))();
  return loaded;
}

}  // namespace becalm::pictures
