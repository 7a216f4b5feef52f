#include "app/file_origin.h"

#include <fmt/format.h>

#include <map>

#include "frame/error.h"
#include "frame/io/exr.h"
#include "frame/io/printable.h"

namespace becalm::app {

nlohmann::ordered_json origin_of(const std::string& path) {
  nlohmann::ordered_json origin = nlohmann::ordered_json::object();
  std::map<std::string, std::string> recorded;
  try {
    recorded = io::read_attributes(path);
  } catch (const Error& error) {
    if (error.status() == ExitStatus::resource) throw;
    return origin;
  }
  for (const char* name : {"version", "command", "preset", "tiles", "settings"}) {
    const std::string& value = recorded[fmt::format("becalm:{}", name)];
    if (!value.empty()) origin[name] = value;
  }
  return origin;
}

std::vector<std::string> origin_lines(const nlohmann::ordered_json& origin) {
  constexpr std::size_t longest = 2000;  // characters of one attribute
  if (!origin.contains("version")) return {};
  std::string text = "becalm:";
  for (const auto& [name, value] : origin.items()) {
    text += fmt::format("{} {} {}", text.back() == ':' ? "" : ";", name,
                        io::printable(value.get<std::string>(), longest));
  }
  return {text};
}

}  // namespace becalm::app
