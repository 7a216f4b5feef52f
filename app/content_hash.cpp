#include "app/content_hash.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <vector>

#include "frame/error.h"

namespace becalm::app {

void ContentHash::add(std::uint64_t word) {
  constexpr std::uint64_t prime = 0x9e3779b97f4a7c15u;
  value_ = std::rotl((value_ ^ word) * prime, 29);
}

void ContentHash::add(std::string_view bytes) {
  std::uint64_t word = 0;
  for (; bytes.size() >= sizeof word; bytes.remove_prefix(sizeof word)) {
    std::memcpy(&word, bytes.data(), sizeof word);
    add(word);
  }
  if (bytes.empty()) return;
  word = bytes.size();  // so that zeros at the end count
  std::memcpy(reinterpret_cast<char*>(&word) + 1, bytes.data(), bytes.size());
  add(word);
}

void ContentHash::add_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    add(std::string_view(block.data(), static_cast<std::size_t>(file.gcount())));
  }
  if (!file.eof()) throw Error(ExitStatus::bad_input, fmt::format("{}: cannot be read", path.string()));
}

std::string ContentHash::text() const {
  return fmt::format("{:016x}", value_);
}

}  // namespace becalm::app
