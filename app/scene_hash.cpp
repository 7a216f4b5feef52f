#include "app/scene_hash.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "app/content_hash.h"
#include "tracer/scene/load/text_words.h"
#include "tracer/scene/load/wavefront_text.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

using Files = std::vector<std::string>;

/// Returns whether there is such a file.
bool add_file(const fs::path& file, Files& files) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  files.push_back(file.string());
  return true;
}

/// Adds the file that the longest end of the text names which begins at a word.
void add_file_at_end(const fs::path& folder, std::string text, Files& files) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  for (std::size_t word = text.find_first_not_of(" \t"); word != std::string::npos;) {
    if (add_file(folder / text.substr(word), files)) return;
    word = text.find_first_not_of(" \t", std::min(text.find_first_of(" \t", word), text.size()));
  }
}

/// The images of a material file: whatever names a file at the end of a line, alone or after options.
void add_images(const fs::path& library, Files& files) {
  std::string text = tracer::read_wavefront_text(library.string()).value_or("");
  std::ranges::replace(text, '\\', '/');
  for (std::string_view lines = text; !lines.empty();) {
    std::string_view line = tracer::take_line(lines);
    tracer::take_word(line);
    add_file_at_end(library.parent_path(), std::string(line), files);
  }
}

/// Returns whether there is such a file.
bool add_library(const fs::path& library, Files& files) {
  if (!add_file(library, files)) return false;
  add_images(library, files);
  return true;
}

/// The material files that an OBJ names, one with blanks in its name or several, and their images.
void add_materials(const fs::path& obj, Files& files) {
  const std::string text = tracer::read_wavefront_text(obj.string()).value_or("");
  for (std::string_view lines = text; !lines.empty();) {
    std::string_view line = tracer::take_line(lines);
    if (tracer::take_word(line) != "mtllib") continue;
    std::string_view names = tracer::trimmed(line);
    if (add_library(obj.parent_path() / names, files)) continue;
    while (!names.empty()) add_library(obj.parent_path() / tracer::take_word(names), files);
  }
}

/// The files of every string in the scene that names one: meshes and images, under whichever key but those
/// of references by name. Of meshes that bring their materials those, too.
void add_named_files(const nlohmann::json& node, const fs::path& folder, Files& files) {
  if (node.is_structured()) {
    for (const auto& [key, child] : node.items()) {
      const bool is_reference = child.is_string() && (key == "name" || key == "material");
      if (!is_reference) add_named_files(child, folder, files);
    }
    if (node.is_object() && node.contains("materials") && node["materials"] == "mtl" &&
        node.contains("obj") && node["obj"].is_string()) {
      add_materials(folder / node["obj"].get<std::string>(), files);
    }
  } else if (node.is_string()) {
    add_file(folder / node.get<std::string>(), files);
  }
}

}  // namespace

std::vector<std::string> files_of_scene(const std::string& scene_file) {
  Files files{scene_file};
  std::ifstream file(scene_file);
  const auto json =
      nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  add_named_files(json, fs::path(scene_file).parent_path(), files);
  return files;
}

std::string scene_hash(const std::vector<std::string>& files) {
  ContentHash hash;
  for (const std::string& file : files) hash.add_file(file);
  return hash.text();
}

}  // namespace becalm::app
