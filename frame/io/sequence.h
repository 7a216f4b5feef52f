#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::io {

/// A frame number as it stands in a file's name.
struct NamedFrame {
  int number = 0;
  int padding = 1;  ///< characters, the sign included
};

/// The frame number in a file's name: the last of its parts between dots that is a number (`shot.0052.exr`,
/// `shot.-001.calm.exr`), or else the digits that end the name (`shot_0052.exr`, `Image0052.exr`). Neither
/// versions (`shot_v02.exr`) nor sizes (`room_640x360.exr`) are frames. None of these: nothing.
std::optional<NamedFrame> frame_in_name(const std::string& path);

/// The pattern that has the file as a frame: `shot.####.exr` for `shot.0052.exr`. Nothing where the name has
/// no frame number.
std::optional<std::string> pattern_of_frame(const std::string& path);

/// The patterns that have these files as frames, each once, and the files without a number as they are; in
/// alphabetical order. Names that differ in the number's digits alone are one pattern, with a lone `#`.
std::vector<std::string> patterns_of_files(std::span<const std::string> paths);

/// The number that a single file's name has, else 1.
int number_in_name(const std::string& path);

/// The first frame field of two characters or more in the path's folders, if the folder with it does not
/// exist; else empty. SequencePattern takes fields of folders literally.
std::string field_of_folder(const std::string& path);

/// A file name with at most one frame field: `####`, `@@@@` (digits = characters), `%04d`, `%d`, `$F4` or
/// `$F`; a lone `#` takes its padding from the files on disk, and 1 digit where there are none. A lone `@`,
/// `%d` or `$F` before a letter or digit is text (`me@home.exr`), and so are a lone `#` beside a longer field
/// (`take#2.####.exr`) and any lone field in the name of a file that exists. Folders hold no field.
class SequencePattern {
 public:
  /// Throws Error(usage) if there are two frame fields in the text, and Error where its folder cannot be
  /// read.
  explicit SequencePattern(std::string text);
  /// A lone `#` has this padding, whatever is on disk.
  SequencePattern(std::string text, int lone_padding);

  /// From now on negative numbers have their sign before the padding if those of `other` do.
  void place_sign_as(const SequencePattern& other) { sign_before_padding_ |= other.sign_before_padding_; }

  const std::string& text() const { return text_; }
  bool has_frame_field() const { return padding_ > 0; }
  /// The least number of characters of a frame number; 0 without a frame field.
  int padding() const { return padding_; }
  /// The file of a frame. The padding counts the sign of negative numbers, `shot.-001.exr` for `####` and -1,
  /// unless the files on disk have it in addition, as Blender's: `shot.-0001.exr`. The text itself where it
  /// has no frame field.
  std::string path(int frame) const;
  /// Numbers of the files that exist, ascending; none where the text has no frame field. Throws Error where
  /// the folder cannot be listed, and Error(bad_input) where a lone `#` finds numbers of two paddings: frames
  /// would be left out.
  std::vector<int> frames_on_disk() const;
  /// Throws Error(bad_input) where numbers on disk are padded wider than the pattern's, and those that it
  /// takes would be taken with them: of `0999` and `1000`, `%d` and `###` take one. For who takes all that is
  /// there.
  void refuse_wider_numbers() const;
  /// What to say behind "not found" where files exist whose numbers have another padding: `; shot.1.exr is
  /// there, and shot.#.exr finds it`, or `; shot.1.exr has another padding` where others have this one; or,
  /// without files, of a lone field: `; '@' stands for the frame number`. Else empty.
  std::string hint_where_missing() const;

 private:
  SequencePattern(std::string text, std::optional<int> lone_padding);

  std::string number_text(int frame) const;

  std::string text_;
  std::string prefix_;
  std::string suffix_;
  std::string lone_field_;            ///< the field, if it is one of a lone character
  int padding_ = 0;                   ///< 0: no frame field
  bool padding_is_found_ = false;     ///< on disk, for a lone `#`
  bool sign_before_padding_ = false;  ///< of negative numbers
};

}  // namespace becalm::io
