#include "app/nearest_name.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace becalm::app {
namespace {

/// Optimal string alignment: letters inserted, left out, replaced, or exchanged with their neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view typed, std::span<const std::string> names) {
  constexpr std::size_t longest = 40;  // characters of a name
  const std::size_t letters = typed.size() - std::min(typed.size(), typed.find_first_not_of('-'));
  if (typed.size() > longest || letters < 2) return "";
  const auto begins = [typed](const std::string& name) { return name.starts_with(typed); };
  const bool is_short = std::ranges::count_if(names, begins) == 1;  // for one name alone
  std::size_t least = 1 + letters / 5;  // what more letters differ in is another name
  std::string nearest;
  for (const std::string& name : names) {
    const std::size_t distance = is_short && begins(name) ? 1 : edit_distance(typed, name);
    if (distance > least || (distance == least && !nearest.empty())) continue;
    least = distance;
    nearest = name;
  }
  return nearest;
}

}  // namespace becalm::app
