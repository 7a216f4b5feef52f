#include "frame/pictures/embedded_library.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "frame/error.h"

namespace becalm {
namespace {

[[noreturn]] void fail(const char* library, const char* reason) {
  throw Error(ExitStatus::resource, fmt::format("{} cannot be loaded: {}", library, reason));
}

/// The bytes in an anonymous file, so that the executable needs no other file beside it.
class LibraryFile {
 public:
  LibraryFile(std::span<const std::byte> rest, const char* library)
      : descriptor_(memfd_create(library, MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail(library, std::strerror(errno));
    while (!rest.empty()) {
      const ssize_t written = write(descriptor_, rest.data(), rest.size());
      if (written < 0 && errno != EINTR) fail(library, std::strerror(errno));
      if (written > 0) rest = rest.subspan(static_cast<std::size_t>(written));
    }
  }
  ~LibraryFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  LibraryFile(const LibraryFile&) = delete;
  LibraryFile& operator=(const LibraryFile&) = delete;

  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

void* load_embedded_library(std::span<const std::byte> bytes, const char* entry, const char* library) {
  const LibraryFile file(bytes, library);
  void* module = dlopen(file.path().c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr) fail(library, dlerror());
  void* address = dlsym(module, entry);
  if (address == nullptr) fail(library, dlerror());
  return address;
}

}  // namespace becalm
