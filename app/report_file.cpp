#include "app/report_file.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "frame/error.h"
#include "frame/io/atomic_file.h"

namespace becalm::app {
namespace fs = std::filesystem;

void write_report_file(const std::string& option, const std::string& path, const std::string& text) {
  if (path == "/dev/stdout") {  // even where that is a file: it holds what was said before
    fmt::print("{}", text);
    return;
  }
  std::error_code ignored;
  if (fs::is_other(path, ignored)) {
    std::ofstream file(path);
    if (!(file << text) || !file.flush()) {
      throw Error(ExitStatus::resource, fmt::format("{} {}: cannot write it", option, path));
    }
    return;
  }
  if (std::ifstream present(path, std::ios::binary); present) {
    std::array<char, 4> magic{};
    present.read(magic.data(), magic.size());
    if (magic == std::array<char, 4>{0x76, 0x2f, 0x31, 0x01})
      throw Error(ExitStatus::usage,
                  fmt::format("{} {}: is an EXR file there; choose another name", option, path));
  }
  try {
    const fs::path behind_links = fs::weakly_canonical(path, ignored);
    io::AtomicFile file(behind_links.empty() ? path : behind_links.string());
    file.write(text.data(), text.size());
    file.commit();
  } catch (const Error& error) {
    throw Error(error.status(), fmt::format("{} {}", option, error.what()));
  }
}

}  // namespace becalm::app
