#include "app/report_file.h"

#include <fmt/format.h>

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
