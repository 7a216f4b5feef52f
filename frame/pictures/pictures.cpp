#include "frame/pictures/pictures.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

#include "frame/error.h"

extern "C" {
// NOLINTBEGIN(readability-identifier-naming): symbols of embedded_module.S
extern const std::byte becalm_pictures_module[];
extern const std::byte becalm_pictures_module_end[];
// NOLINTEND(readability-identifier-naming)
}

namespace becalm::pictures {
namespace {

[[noreturn]] void fail(const char* reason) {
  throw Error(ExitStatus::resource, fmt::format("OpenImageIO cannot be loaded: {}", reason));
}

/// The module's bytes in an anonymous file, so that the executable needs no other file beside it.
class ModuleFile {
 public:
  ModuleFile() : descriptor_(memfd_create("becalm_pictures", MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail(std::strerror(errno));
    std::span<const std::byte> rest(becalm_pictures_module, becalm_pictures_module_end);
    while (!rest.empty()) {
      const ssize_t written = write(descriptor_, rest.data(), rest.size());
      if (written < 0 && errno != EINTR) fail(std::strerror(errno));
      if (written > 0) rest = rest.subspan(static_cast<std::size_t>(written));
    }
  }
  ~ModuleFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  ModuleFile(const ModuleFile&) = delete;
  ModuleFile& operator=(const ModuleFile&) = delete;

  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

Library& load() {
  const ModuleFile file;
  void* module = dlopen(file.path().c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr) fail(dlerror());
  void* entry = dlsym(module, "becalm_pictures_library");
  if (entry == nullptr) fail(dlerror());
  return *reinterpret_cast<Library* (*)()>(entry)();
}

}  // namespace

Library& library() {
  static Library& loaded = load();
  return loaded;
}

}  // namespace becalm::pictures
