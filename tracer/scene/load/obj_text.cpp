#include "tracer/scene/load/obj_text.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <limits>
#include <optional>
#include <string_view>

#include "tracer/scene/load/fail_in_file.h"
#include "tracer/scene/load/text_words.h"
#include "tracer/scene/load/wavefront_text.h"

namespace becalm::tracer {

namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 19;

/// How many elements stand before something in the file.
struct Counts {
  int positions = 0, normals = 0, uvs = 0;
};

struct LineError {
  int line;
  std::string message;
};

/// What some lines say on their own. Indices are those of the file: from 1, or negative and relative to the
/// elements before their face; 0 where a corner has none. Faces and lines are counted from the block's begin.
struct Block {
  ObjText text;
  std::vector<Counts> counts;  ///< for each face, what stands before it in the block
  int lines = 0;
  std::optional<LineError> bad_coordinate, bad_index;  ///< the first ones

  Counts size() const {
    return {static_cast<int>(text.positions.size()), static_cast<int>(text.normals.size()),
            static_cast<int>(text.uvs.size())};
  }
};

/// Reads the statements of one block.
class BlockReader {
 public:
  Block read(std::string_view text) {
    while (!text.empty()) {
      ++block_.lines;
      read_line(take_line(text));
    }
    return std::move(block_);
  }

 private:
  void read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    const std::string_view values = without_comment(line);
    ObjText& text = block_.text;
    if (keyword == "v") {
      text.positions.push_back(read_coordinates<V3f>(keyword, values));
    } else if (keyword == "vn") {
      text.normals.push_back(read_coordinates<V3f>(keyword, values));
    } else if (keyword == "vt") {
      text.uvs.push_back(read_coordinates<V2f>(keyword, values, /*least=*/1));
    } else if (keyword == "f") {
      read_face(values);
    } else if (keyword == "usemtl") {
      text.materials.push_back(
          {static_cast<std::uint32_t>(text.face_ends.size()), std::string(trimmed(line))});
    } else if (keyword == "mtllib") {
      text.libraries.emplace_back(trimmed(line));
    }
  }

  /// Those behind the `least` first may be left out and are 0.
  template <class Vec>
  Vec read_coordinates(std::string_view keyword, std::string_view line, unsigned least = Vec::dimensions()) {
    Vec v(0.0f);
    for (unsigned i = 0; i < Vec::dimensions(); ++i) {
      const std::string_view word = take_word(line);
      if (word.empty() && i >= least) break;
      const std::optional<float> number = parse_float(word);
      if (number) {
        v[static_cast<int>(i)] = *number;
      } else if (!block_.bad_coordinate) {
        const std::string fewest =
            word.empty() && least < Vec::dimensions() ? fmt::format("{} to ", least) : "";
        block_.bad_coordinate =
            LineError{block_.lines, fmt::format("'{}' needs {}{} finite numbers, found '{}'", keyword, fewest,
                                                Vec::dimensions(), word)};
      }
    }
    return v;
  }

  void read_face(std::string_view line) {
    std::vector<ObjCorner>& corners = block_.text.corners;
    const std::size_t first = corners.size();
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line))
      corners.push_back(read_corner(word));
    if (corners.size() - first < 3) {
      corners.resize(first);  // a point or a line
      return;
    }
    block_.text.face_ends.push_back(static_cast<std::uint32_t>(corners.size()));
    block_.counts.push_back(block_.size());
  }

  /// Of `i`, `i/uv`, `i//normal` or `i/uv/normal`.
  ObjCorner read_corner(std::string_view word) {
    ObjCorner corner{0, 0, 0};
    std::string_view rest = word;
    bool valid = read_index(rest, corner.position);
    if (valid && !rest.empty() && !rest.starts_with("//")) {
      rest.remove_prefix(1);
      valid = read_index(rest, corner.uv);
    } else if (valid && !rest.empty()) {
      rest.remove_prefix(1);
    }
    if (valid && !rest.empty()) {
      rest.remove_prefix(1);
      valid = read_index(rest, corner.normal) && rest.empty();
    }
    if (!valid && !block_.bad_index) {
      block_.bad_index =
          LineError{block_.lines, fmt::format("'f' needs indices other than 0, found '{}'", word)};
    }
    return corner;
  }

  /// Takes what stands before the next slash. False if it is not a number or 0.
  static bool read_index(std::string_view& rest, int& index) {
    std::string_view digits = rest.substr(0, rest.find('/'));
    rest.remove_prefix(digits.size());
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (error == std::errc::result_out_of_range)
      index = digits.starts_with('-') ? -std::numeric_limits<int>::max() : std::numeric_limits<int>::max();
    return index != 0 && stop == digits.data() + digits.size();
  }

  Block block_;
};

/// The text in pieces of about kBlockBytes that end at the end of a line.
std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n', std::min(kBlockBytes, text.size())), text.size() - 1);
    pieces.push_back(text.substr(0, end + 1));
    text.remove_prefix(end + 1);
  }
  return pieces;
}

/// Throws the first error of the file; `error` is Block's member of its kind.
void check(const std::string& path, const std::vector<Block>& blocks,
           std::optional<LineError> Block::*error) {
  int lines_before = 0;
  for (const Block& block : blocks) {
    if (const std::optional<LineError>& found = block.*error)
      fail_in_file(path, fmt::format("line {}: {}", lines_before + found->line, found->message));
    lines_before += block.lines;
  }
}

/// Where a block's statements begin in the whole file's.
struct Start {
  Counts elements;
  std::size_t corners = 0, faces = 0;
};

/// Copies a block to its place, indices made absolute. Returns what is wrong with its first bad one.
std::optional<std::string> place(const Block& block, const Start& start, ObjText& whole) {
  const ObjText& part = block.text;
  std::ranges::copy(part.positions, whole.positions.begin() + start.elements.positions);
  std::ranges::copy(part.normals, whole.normals.begin() + start.elements.normals);
  std::ranges::copy(part.uvs, whole.uvs.begin() + start.elements.uvs);
  std::optional<std::string> message;
  std::size_t corner = 0;
  for (std::size_t face = 0; face < part.face_ends.size(); ++face) {
    const auto absolute = [&](const char* what, int index, int before_block, int in_block,
                              std::size_t count) {
      const std::int64_t number =
          index > 0 ? std::int64_t{index} - 1 : std::int64_t{before_block} + in_block + index;
      if (number >= 0 && number < static_cast<std::int64_t>(count)) return static_cast<int>(number);
      if (!message) {
        message = fmt::format("face {}: {} index {} is outside the file's {}", start.faces + face + 1, what,
                              number + 1, count);
      }
      return 0;
    };
    const Counts& before = start.elements;
    const Counts& counts = block.counts[face];
    for (; corner < part.face_ends[face]; ++corner) {
      const ObjCorner& from = part.corners[corner];
      ObjCorner& to = whole.corners[start.corners + corner];
      to.position =
          absolute("vertex", from.position, before.positions, counts.positions, whole.positions.size());
      to.normal = from.normal == 0
                      ? ObjCorner::kNone
                      : absolute("normal", from.normal, before.normals, counts.normals, whole.normals.size());
      to.uv =
          from.uv == 0 ? ObjCorner::kNone : absolute("uv", from.uv, before.uvs, counts.uvs, whole.uvs.size());
    }
    whole.face_ends[start.faces + face] = static_cast<std::uint32_t>(start.corners + corner);
  }
  return message;
}

/// The blocks one after the other.
ObjText join(const std::string& path, const std::vector<Block>& blocks) {
  ObjText whole;
  std::vector<Start> starts;
  Start next;
  for (const Block& block : blocks) {
    starts.push_back(next);
    for (const ObjText::UseMaterial& use : block.text.materials)
      whole.materials.push_back({static_cast<std::uint32_t>(next.faces) + use.first_face, use.name});
    whole.libraries.insert(whole.libraries.end(), block.text.libraries.begin(), block.text.libraries.end());
    const Counts size = block.size();
    next.elements.positions += size.positions;
    next.elements.normals += size.normals;
    next.elements.uvs += size.uvs;
    next.corners += block.text.corners.size();
    next.faces += block.text.face_ends.size();
  }
  whole.positions.resize(static_cast<std::size_t>(next.elements.positions));
  whole.normals.resize(static_cast<std::size_t>(next.elements.normals));
  whole.uvs.resize(static_cast<std::size_t>(next.elements.uvs));
  whole.corners.resize(next.corners);
  whole.face_ends.resize(next.faces);
  std::vector<std::optional<std::string>> messages(blocks.size());
  tbb::parallel_for(std::size_t{0}, blocks.size(),
                    [&](std::size_t i) { messages[i] = place(blocks[i], starts[i], whole); });
  for (const std::optional<std::string>& message : messages) {
    if (message) fail_in_file(path, *message);
  }
  return whole;
}

}  // namespace

ObjText read_obj(const std::string& path) {
  const std::optional<std::string> contents = read_wavefront_text(path);
  if (!contents) fail_in_file(path, "cannot read the mesh file");
  const std::vector<std::string_view> pieces = split(*contents);
  std::vector<Block> blocks(pieces.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(),
                    [&](std::size_t i) { blocks[i] = BlockReader().read(pieces[i]); });
  check(path, blocks, &Block::bad_coordinate);
  check(path, blocks, &Block::bad_index);
  return join(path, blocks);
}

}  // namespace becalm::tracer
