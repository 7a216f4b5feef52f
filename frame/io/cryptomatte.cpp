#include "frame/io/cryptomatte.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <string_view>

namespace becalm::io {
namespace {

/// Whether a channel or part of this name holds ranks of the matte, such as `CryptoObject00.R`.
bool is_of_matte(std::string_view name, std::string_view matte) {
  return name.size() > matte.size() && name.starts_with(matte) &&
         std::isdigit(static_cast<unsigned char>(name[matte.size()])) != 0;
}

bool has_matte(const std::vector<Imf::Header>& headers, std::string_view matte) {
  return std::ranges::any_of(headers, [&](const Imf::Header& header) {
    if (header.hasName() && is_of_matte(header.name(), matte)) return true;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
      if (is_of_matte(it.name(), matte)) return true;
    }
    return false;
  });
}

/// The header without attributes whose names begin so. It is made anew: OpenEXR's erase() leaks.
Imf::Header without(const Imf::Header& header, const std::set<std::string>& beginnings) {
  Imf::Header kept;
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string_view name = it.name();
    const auto begins = [name](const std::string& beginning) { return name.starts_with(beginning); };
    if (std::ranges::none_of(beginnings, begins)) kept.insert(it.name(), it.attribute());
  }
  return kept;
}

}  // namespace

void leave_out_mattes(const std::vector<Imf::Header>& before, std::vector<Imf::Header>& headers) {
  constexpr std::string_view scope = "cryptomatte/";
  constexpr std::string_view end = "name";
  std::set<std::string> gone;  // `cryptomatte/ID/`
  for (const Imf::Header& header : before) {
    for (auto it = header.begin(); it != header.end(); ++it) {
      const std::string name = it.name();
      const auto* matte = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
      if (matte == nullptr || !name.starts_with(scope) || !name.ends_with("/name")) continue;
      if (has_matte(before, matte->value()) && !has_matte(headers, matte->value()))
        gone.insert(name.substr(0, name.size() - end.size()));
    }
  }
  if (gone.empty()) return;
  for (Imf::Header& header : headers) header = without(header, gone);
}

}  // namespace becalm::io
