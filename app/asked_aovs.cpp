#include "app/asked_aovs.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "frame/error.h"

namespace becalm::app {
namespace {

/// The word of --aovs for one layer a light group.
constexpr std::string_view kLightGroups = "light_groups";

bool made_by_tracer(const AovInfo& entry) {
  return !entry.diagnostic && entry.aov != Aov::beauty;
}

/// Without those around it, as in `albedo, normal`.
std::string without_blanks(const std::string& text) {
  const std::size_t first = std::min(text.find_first_not_of(' '), text.size());
  return text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

}  // namespace

AskedAovs parse_aovs(const std::string& text) {
  AovSet all;
  std::string names;
  for (const AovInfo& entry : kAovTable) {
    if (!made_by_tracer(entry)) continue;
    all.set(static_cast<std::size_t>(entry.aov));
    names += fmt::format("{}, ", entry.name);
  }
  AskedAovs chosen;
  bool takes_all = false;
  if (text == "none") return chosen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string name = without_blanks(text.substr(begin, comma - begin));
    begin = comma + 1;
    chosen.light_groups |= name == kLightGroups;
    takes_all |= name == "all";
    if (name == kLightGroups || name == "all") continue;
    const std::optional<Aov> aov = find_aov(name);
    if (!aov || info(*aov).diagnostic) {
      throw Error(ExitStatus::usage,
                  fmt::format("--aovs: no AOV '{}'{}; expected some of {}{}, all or none", name,
                              aov ? " of the tracer (the filter's come with --diagnostics)" : "", names,
                              kLightGroups));
    }
    chosen.named.set(static_cast<std::size_t>(*aov), *aov != Aov::beauty);
  }
  chosen.aovs = takes_all ? all : chosen.named;
  return chosen;
}

std::string format_aovs(const AskedAovs& asked) {
  std::string text;
  for (const AovInfo& entry : kAovTable) {
    if (!contains(asked.aovs, entry.aov)) continue;
    text += fmt::format("{}{}", text.empty() ? "" : ",", entry.name);
  }
  if (asked.light_groups) text += fmt::format("{}{}", text.empty() ? "" : ",", kLightGroups);
  return text.empty() ? "none" : text;
}

}  // namespace becalm::app
