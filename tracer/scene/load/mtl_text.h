#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::tracer {

/// A material's statements by their keywords, each with its first line: tinyobjloader does not tell what is
/// absent from what is 0.
using MtlStatements = std::map<std::string, int, std::less<>>;

/// A Wavefront material file as tinyobjloader can read it, and what that would not tell.
struct MtlText {
  std::string text;  ///< with three numbers behind each colour, -o, -s and -t, which may have fewer
  std::map<std::string, MtlStatements> materials;
  std::vector<std::string> warnings;  ///< as mtl_warning: what is left out or taken as something else
};

/// Throws Error(bad_input) for a file that cannot be read, and `FILE: line N: ...` for what should be numbers
/// and is not: tinyobjloader would take it for 0.
MtlText read_mtl(const std::string& path);

/// `FILE: line N: material 'M': message`.
std::string mtl_warning(const std::string& path, int line, std::string_view material,
                        std::string_view message);

}  // namespace becalm::tracer
