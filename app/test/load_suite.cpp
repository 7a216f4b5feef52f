#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "app/asked_aovs.h"
#include "app/byte_size.h"
#include "app/frame_size.h"
#include "app/test/load_judges.h"
#include "app/test/suite.h"
#include "filter/settings.h"
#include "frame/error.h"
#include "frame/io/frame_range.h"
#include "frame/io/read_error.h"
#include "frame/names_in.h"
#include "tracer/sample_counts.h"
#include "tracer/scene/load/json_reader.h"

namespace becalm::app {
namespace {

namespace fs = std::filesystem;
using tracer::JsonValue;

constexpr int kLargestSeed = 0x7fffffff;

/// Relative paths of a suite are from its file.
std::string from_suite(const std::string& suite_file, const std::string& path) {
  return (fs::path(suite_file).parent_path() / path).lexically_normal().string();
}

/// False, instead of an exception, for a path that no file system can have.
bool is_file(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// What `parse` makes of the text of an option of becalm, which fails at the text's place.
template <class Parse>
auto parsed(const JsonValue& json, const std::string& text, const Parse& parse) {
  try {
    return parse(text);
  } catch (const Error& error) {
    json.fail(error.what());
  }
}

std::string read_size(const JsonValue& json) {
  std::string size = json.string();
  parsed(json, size, parse_size);
  return size;
}

std::string read_preset(const JsonValue& json) {
  if (!json.is_object() && !json.is_array()) {
    const std::string text = json.string();
    std::vector<std::string_view> choices{"none"};
    choices.insert(choices.end(), filter::kPresets.begin(), filter::kPresets.end());
    json.choice(choices);
    return text == "none" ? "" : text;
  }
  return json.string();
}

std::vector<std::string> read_strings(const JsonValue& json) {
  std::vector<std::string> strings;
  for (const JsonValue& element : json.elements()) strings.push_back(element.string());
  return strings;
}

std::vector<std::string> read_aovs(const JsonValue& json) {
  std::vector<std::string> aovs = read_strings(json);
  if (!aovs.empty()) parsed(json, fmt::format("{}", fmt::join(aovs, ",")), parse_aovs);
  std::erase(aovs, "none");  // which stands alone; a case may replace its defaults by it
  return aovs;
}

CommandTemplate read_words(const JsonValue& json) {
  CommandTemplate command = read_strings(json);
  if (command.empty() || command.front().empty()) json.fail("expected a program and its arguments");
  return command;
}

CommandTemplate read_command(const JsonValue& json) {
  CommandTemplate command = read_words(json);
  if (!has_placeholder(command, "{output}")) {
    json.fail("expected {output} in one of the arguments, where the command writes its EXR file");
  }
  return command;
}

std::vector<CommandTemplate> read_prepare(const JsonValue& json) {
  std::vector<CommandTemplate> commands;
  for (const JsonValue& element : json.elements()) {
    commands.push_back(read_words(element));
    if (has_placeholder(commands.back(), "{output}")) {
      element.fail("{output} is what 'command' writes; expected {work}, the folder for what is prepared");
    }
  }
  return commands;
}

/// Changes `source`, which holds the suite's defaults.
void read_source(const JsonValue& json, const std::string& suite_file, CaseSource& source) {
  json.allow_keys({"scene", "command", "prepare", "frames", "spp", "seed", "size", "aovs", "denoise",
                   "timeout_s", "memory"});
  const auto scene = json.find("scene");
  const auto command = json.find("command");
  if (scene && command) command->fail("expected either a scene or a command, found both");
  if (scene) {
    source.scene = from_suite(suite_file, scene->string());
    source.command.clear();
    source.prepare.clear();
    if (!is_file(source.scene)) scene->fail(fmt::format("no file {}", source.scene));
  }
  if (command) {
    source.command = read_command(*command);
    source.scene.clear();
    // What defaults say of scenes alone.
    source.size.clear();
    source.aovs.clear();
    source.preset.clear();
  }
  if (const auto prepare = json.find("prepare")) source.prepare = read_prepare(*prepare);
  if (const auto frames = json.find("frames"))
    source.frames = parsed(*frames, frames->string(),
                           [](const std::string& text) { return io::parse_frame_range(text); });
  if (const auto spp = json.find("spp")) source.spp = spp->integer(1, tracer::kMostSamples);
  if (const auto seed = json.find("seed")) {
    source.seed = static_cast<std::uint32_t>(seed->integer(0, kLargestSeed));
  }
  if (const auto size = json.find("size")) source.size = read_size(*size);
  if (const auto aovs = json.find("aovs")) source.aovs = read_aovs(*aovs);
  if (const auto preset = json.find("denoise")) source.preset = read_preset(*preset);
  if (const auto timeout = json.find("timeout_s")) source.timeout_s = timeout->number(0.001, 1e6);
  if (const auto memory = json.find("memory")) {
    const std::optional<std::uint64_t> bytes = parse_bytes(memory->string());
    if (!bytes) {
      memory->fail(
          fmt::format("expected a size with its unit, such as 512M or 1.5G, found {}", memory->string()));
    }
    source.memory_bytes = *bytes;
  }
}

void check_source(const JsonValue& json, const CaseSource& source) {
  if (source.scene.empty() && source.command.empty()) json.fail("expected a 'scene' or a 'command'");
  if (source.command.empty()) {
    if (const auto prepare = json.find("prepare"))
      prepare->fail("is for a command, and the source is a scene");
    return;
  }
  // Options of becalm render would silently do nothing.
  for (const char* key : {"size", "aovs", "denoise"}) {
    if (const auto value = json.find(key)) value->fail("is for a scene, and the source is a command");
  }
}

/// Members that would be ignored, and one that cannot be guessed.
void check_reference(const JsonValue& json, const TestCase& test) {
  const ReferenceSettings& settings = test.reference;
  const auto reference = json.find("reference");
  const auto fail_at = [&](const char* key, const std::string& message) {
    const auto member = reference ? reference->find(key) : std::nullopt;
    (member ? *member : json).fail(message);
  };
  const bool by_command = !test.source.command.empty() || !settings.command.empty();
  if (by_command && !settings.preset.value_or("").empty()) {
    fail_at("denoise", "'denoise' is for references that a scene makes, and a command makes these");
  }
  const bool has_command = !settings.command.empty();
  if (test.judges.statistical && has_command && !settings.spp &&
      !has_placeholder(settings.command, "{spp}")) {
    fail_at("command",
            "statistical needs the samples per pixel of this command: 'spp' beside it, or {spp} in it");
  }
  if (test.judges.statistical && reference_count(test) * reference_spp(test) < 2) {
    fail_at("spp", "statistical needs references of two samples per pixel or more, found 1");
  }
}

void read_reference(const JsonValue& json, ReferenceSettings& reference) {
  json.allow_keys({"command", "spp", "seed", "count", "denoise"});
  if (const auto command = json.find("command")) reference.command = read_command(*command);
  if (const auto spp = json.find("spp")) reference.spp = spp->integer(1, tracer::kMostSamples);
  if (const auto seed = json.find("seed")) {
    reference.seed = static_cast<std::uint32_t>(seed->integer(0, kLargestSeed));
  }
  if (const auto count = json.find("count")) reference.count = count->integer(1, 2);
  if (const auto preset = json.find("denoise")) reference.preset = read_preset(*preset);
}

/// Of a case; a folder may have 255.
constexpr std::size_t kLongestName = 200;

/// The name becomes a folder's.
void check_name(const JsonValue& json, const std::string& name) {
  const auto is_plain = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; };
  if (name.empty() || name.size() > kLongestName || name.front() == '.' ||
      !std::ranges::all_of(name, is_plain)) {
    json.fail(
        fmt::format("expected a name of letters, digits and . _ - of at most {} characters that does not "
                    "begin with a dot",
                    kLongestName));
  }
}

/// Sets what the members of a case, or of the defaults, say.
void read_members(const JsonValue& json, const std::string& suite_file, TestCase& test) {
  json.allow_keys({"source", "reference", "layer", "judged_by", "false_alarm_rate"});
  if (const auto source = json.find("source")) read_source(*source, suite_file, test.source);
  if (const auto reference = json.find("reference")) read_reference(*reference, test.reference);
  if (const auto rate = json.find("false_alarm_rate")) test.false_alarm_rate = rate->number(1e-12, 0.5);
  if (const auto layer = json.find("layer")) test.layer = layer->string();
  if (const auto judges = json.find("judged_by")) read_judges(*judges, test.judges);
}

std::vector<TestCase> load_suite(const std::string& file, const std::string& name_of_suite) {
  std::error_code error;
  if (!fs::exists(file, error)) throw Error(ExitStatus::bad_input, file + ": no such suite file");
  const nlohmann::json document = tracer::parse_json_file(file);
  const JsonValue root(document, file, "");
  root.allow_keys({"defaults", "cases"});
  TestCase defaults;
  defaults.suite = name_of_suite;
  defaults.suite_file = file;
  if (const auto json = root.find("defaults")) read_members(*json, file, defaults);
  std::vector<TestCase> cases;
  for (const auto& [name, json] : root.at("cases").members()) {
    check_name(json, name);
    TestCase test = defaults;
    test.name = name;
    test.reference_folder = from_suite(file, "references/" + name);
    read_members(json, file, test);
    check_source(json.has("source") ? json.at("source") : json, test.source);
    check_judges(json, test);
    check_reference(json, test);
    cases.push_back(std::move(test));
  }
  if (cases.empty()) root.at("cases").fail("expected at least one case");
  return cases;
}

std::vector<std::string> suite_files(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<std::string> files;
  for (const std::string& name : names_in(path, error)) {
    if (fs::path(name).extension() == ".json") files.push_back((fs::path(path) / name).string());
  }
  if (error) io::fail_to_read(path, error, "folder cannot be listed");
  if (files.empty()) throw Error(ExitStatus::bad_input, path + ": no suite (*.json) in this folder");
  std::ranges::sort(files);
  return files;
}

/// The deepest folder that holds all of them.
fs::path common_folder(const std::vector<fs::path>& files) {
  fs::path common = files.front().parent_path();
  const auto holds = [&](const fs::path& file) { return *file.lexically_relative(common).begin() != ".."; };
  while (!std::ranges::all_of(files, holds)) common = common.parent_path();
  return common;
}

/// A path's names joined by dots, the last one without its ending.
std::string dotted(const fs::path& file) {
  std::string joined;
  for (const fs::path& name : file.parent_path()) joined += name.string() + '.';
  return joined + file.stem().string();
}

/// A suite's name is its file's without the ending. Files of one name have the folders before it that their
/// common folder has not. Throws Error(bad_input) where that is the name of another suite.
std::vector<std::string> suite_names(const std::vector<std::string>& files) {
  std::map<std::string, std::vector<fs::path>> by_stem;
  for (const std::string& file : files) {
    const fs::path place = fs::absolute(file).lexically_normal();
    by_stem[place.stem().string()].push_back(place);
  }
  std::vector<std::string> names;
  std::map<std::string, fs::path> places;
  for (const std::string& file : files) {
    const fs::path place = fs::absolute(file).lexically_normal();
    const std::vector<fs::path>& namesakes = by_stem.at(place.stem().string());
    names.push_back(dotted(place.lexically_relative(common_folder(namesakes))));
    const auto [other, is_new] = places.emplace(names.back(), place);
    if (is_new || other->second == place) continue;
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: its suite would be called {}, and so is that of {}; rename one", file,
                            names.back(), other->second.string()));
  }
  return names;
}

}  // namespace

std::vector<TestCase> load_suites(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) std::ranges::move(suite_files(path), std::back_inserter(files));
  const std::vector<std::string> names = suite_names(files);
  std::vector<TestCase> cases;
  std::set<std::string> folders;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (TestCase& test : load_suite(files[i], names[i])) {
      if (!folders.insert(fs::weakly_canonical(test.reference_folder).string()).second) {
        throw Error(ExitStatus::bad_input,
                    fmt::format("{}: /cases/{}: another case has the same references, {}", files[i],
                                test.name, test.reference_folder));
      }
      cases.push_back(std::move(test));
    }
  }
  return cases;
}

}  // namespace becalm::app
