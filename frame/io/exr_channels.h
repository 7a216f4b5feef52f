#pragma once

#include <Imath/ImathBox.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "frame/image.h"

namespace becalm::io {

/// Every channel of a file, part by part, whatever becalm takes it for.
class ExrChannels {
 public:
  struct Part {
    std::string name;  ///< empty where it has none
    Imath::Box2i data_window;
    Imath::Box2i display_window;
    std::vector<std::string> channels;  ///< none of a deep part
    bool is_deep = false;
  };

  /// Reads the headers. Throws as read_exr does.
  explicit ExrChannels(const std::string& path);
  ~ExrChannels();

  const std::vector<Part>& parts() const { return parts_; }
  bool stores_half(std::size_t part, const std::string& channel) const;
  /// The pixels of a channel, of the data window's size or, where it is subsampled, smaller. Integers come as
  /// two channels, since a float cannot hold them: their upper and their lower 16 bits.
  Image read(std::size_t part, const std::string& channel) const;

 private:
  struct File;
  std::string path_;
  std::unique_ptr<File> file_;
  std::vector<Part> parts_;
};

/// Throws as read_exr does unless every chunk of the file is there and those of its flat parts can be
/// decompressed, a stripe of lines at a time. It need not hold anything that becalm knows.
void require_whole_exr(const std::string& path);

}  // namespace becalm::io
