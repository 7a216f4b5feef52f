#include "app/scene_hash.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/content_hash.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

/// The files of every string in the scene that names one: meshes and images, under whichever key.
void add_named_files(const nlohmann::json& node, const fs::path& folder, ContentHash& hash) {
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
  ContentHash hash;
  hash.add_file(scene_file);
  std::ifstream file(scene_file);
  const auto json =
      nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  add_named_files(json, fs::path(scene_file).parent_path(), hash);
  return hash.text();
}

}  // namespace becalm::app
