#include "frame/io/read_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace becalm::io {

void fail_to_read(const std::string& path, const std::error_code& reason, const std::string& what) {
  using std::errc;
  constexpr std::array of_path{
      errc::no_such_file_or_directory, errc::not_a_directory, errc::permission_denied,
      errc::operation_not_permitted,   errc::is_a_directory,  errc::too_many_symbolic_link_levels,
      errc::filename_too_long};
  const bool is_of_path = std::ranges::any_of(of_path, [&](errc code) { return reason == code; });
  throw ReadError(is_of_path ? ExitStatus::bad_input : ExitStatus::resource,
                  fmt::format("{}: {}: {}", path, what, reason.message()));
}

}  // namespace becalm::io
