#pragma once

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "frame/io/exr.h"
#include "frame/io/stripe.h"

namespace becalm::io {

/// Size and time of a file, to notice that it changed between reading it and passing channels on.
struct FileStamp {
  std::uintmax_t size = 0;
  std::filesystem::file_time_type time;

  bool operator==(const FileStamp&) const = default;
};

/// What LoadedFrame keeps of its file: where it lies, and, if asked, channels that are passed on. Others are
/// read when the result is written.
class ExrContents {
 public:
  ExrContents(std::string path, FileStamp stamp) : path_(std::move(path)), stamp_(stamp) {}

  const std::string& path() const { return path_; }
  const FileStamp& stamp() const { return stamp_; }
  /// Channels of a part in all of its lines, or null.
  const Stripe* kept(int part) const {
    const auto found = kept_.find(part);
    return found == kept_.end() ? nullptr : &found->second;
  }
  void keep(int part, Stripe channels) { kept_.insert_or_assign(part, std::move(channels)); }

 private:
  std::string path_;
  FileStamp stamp_;
  std::map<int, Stripe> kept_;
};

/// Runs `work`, turning what OpenEXR throws about the file `path` into Error(bad_input), and what the system
/// refuses into a ReadError.
void reading(const std::string& path, const std::function<void()>& work);

/// Throws Error(bad_input) where there is no such file, and while reading(): where it is no EXR, or its image
/// is too large.
FileStamp stamp_of(const std::string& path);
std::unique_ptr<Imf::MultiPartInputFile> open_exr(const std::string& path);

/// What find_layers needs of each part. A deep part has no channels that could be used.
std::vector<PartChannels> part_channels(const Imf::MultiPartInputFile& file);

bool is_deep(const Imf::Header& header);
/// Throws Error(bad_input) where all parts are deep.
void require_flat(const std::string& path, const Imf::MultiPartInputFile& file);
bool is_tiled(const Imf::Header& header);
/// The text of an attribute; empty where there is none.
std::string text_attribute(const Imf::Header& header, const char* name);
/// Whether the file tells which pixels of a checkerboard it holds.
bool is_checkerboard(const Imf::MultiPartInputFile& file);

/// The number of chunks (runs of lines, or tiles) that a part of this header has.
std::uint64_t chunk_count(const Imf::Header& header);

/// While reading(): throws where a chunk of pixels is missing or ends behind the file's end, in any part.
/// Reads the chunks' sizes only, and must have passed before anything of the image's size is allocated: a
/// header may claim any size.
void require_all_chunks(const std::string& path, const Imf::MultiPartInputFile& file);

}  // namespace becalm::io
