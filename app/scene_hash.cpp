#include "app/scene_hash.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "frame/error.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

/// FNV-1a, 64 bits: tells edits apart, which is all that is asked of it.
class Hash {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  }
  void add_file(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(ExitStatus::bad_input, fmt::format("{}: cannot be read", path.string()));
    std::array<char, 1 << 16> block;
    while (file.read(block.data(), block.size()) || file.gcount() > 0) {
      add({block.data(), static_cast<std::size_t>(file.gcount())});
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

/// Meshes and images are whatever strings of the scene name files: no key has to be known here.
void add_named_files(const nlohmann::json& node, const fs::path& folder, Hash& hash) {
  if (node.is_structured()) {
    for (const nlohmann::json& child : node) add_named_files(child, folder, hash);
  } else if (node.is_string()) {
    const fs::path file = folder / node.get<std::string>();
    std::error_code error;
    if (fs::is_regular_file(file, error)) hash.add_file(file);
  }
}

}  // namespace

std::string scene_hash(const std::string& scene_file) {
  Hash hash;
  hash.add_file(scene_file);
  std::ifstream file(scene_file);
  const auto json =
      nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  add_named_files(json, fs::path(scene_file).parent_path(), hash);
  return fmt::format("{:016x}", hash.value());
}

}  // namespace becalm::app
