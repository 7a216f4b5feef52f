#include "app/scene_hash.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/content_hash.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

/// Returns whether there is such a file.
bool add_file(const fs::path& file, ContentHash& hash) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  hash.add_file(file);
  return true;
}

/// The images of a material file: whatever names a file at the end of a line, alone or after options.
void add_images(const fs::path& library, ContentHash& hash) {
  std::ifstream lines(library);
  for (std::string line; std::getline(lines, line);) {
    std::ranges::replace(line, '\\', '/');
    std::istringstream words(line);
    std::string word;
    words >> word;
    std::string rest;
    std::getline(words >> std::ws, rest);
    while (!rest.empty() && std::isspace(static_cast<unsigned char>(rest.back()))) rest.pop_back();
    if (rest.empty() || add_file(library.parent_path() / rest, hash)) continue;
    add_file(library.parent_path() / rest.substr(rest.find_last_of(" \t") + 1), hash);
  }
}

/// The material files that an OBJ names, and their images.
void add_materials(const fs::path& obj, ContentHash& hash) {
  std::ifstream lines(obj);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "mtllib") continue;
    while (words >> word) {
      const fs::path library = obj.parent_path() / word;
      if (add_file(library, hash)) add_images(library, hash);
    }
  }
}

/// The files of every string in the scene that names one: meshes and images, under whichever key. Of meshes
/// that bring their materials those, too.
void add_named_files(const nlohmann::json& node, const fs::path& folder, ContentHash& hash) {
  if (node.is_structured()) {
    for (const nlohmann::json& child : node) add_named_files(child, folder, hash);
    if (node.is_object() && node.contains("materials") && node["materials"] == "mtl" &&
        node.contains("obj") && node["obj"].is_string()) {
      add_materials(folder / node["obj"].get<std::string>(), hash);
    }
  } else if (node.is_string()) {
    add_file(folder / node.get<std::string>(), hash);
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
