#include "frame/io/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/openexr.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>

#include "frame/error.h"

namespace becalm::io {
namespace fs = std::filesystem;

namespace {

/// OpenEXR's message in one line, without the file's name, which ours begins with.
std::string reason(const std::string& path, std::string message) {
  const std::string naming = fmt::format("\"{}\". ", path);
  if (const std::size_t at = message.find(naming); at != std::string::npos)
    message.erase(0, at + naming.size());
  std::replace(message.begin(), message.end(), '\n', ' ');
  while (!message.empty() && (message.back() == ' ' || message.back() == '.')) message.pop_back();
  return message;
}

std::once_flag threads_were_set;

/// OpenEXR's limits and its thread pool belong to the process.
void prepare_library() {
  static const bool limited = [] {
    Imf::Header::setMaxImageSize(kMaxImageSide, kMaxImageSide);
    Imf::Header::setMaxTileSize(kMaxImageSide, kMaxImageSide);
    return true;
  }();
  static_cast<void>(limited);
  std::call_once(threads_were_set, [] {
    const int processors = static_cast<int>(std::thread::hardware_concurrency());
    if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(processors > 1 ? processors : 0);
  });
}

/// The file as OpenEXR's C interface sees it, which can look at chunks without reading them.
class ChunkTable {
 public:
  ChunkTable(const std::string& path, std::uint64_t file_size) : file_size_(file_size) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {
    };  // the default one prints
    settings.max_image_width = settings.max_image_height = kMaxImageSide;
    settings.max_tile_width = settings.max_tile_height = kMaxImageSide;
    require(exr_start_read(&context_, path.c_str(), &settings));
  }
  ChunkTable(const ChunkTable&) = delete;
  ChunkTable& operator=(const ChunkTable&) = delete;
  ~ChunkTable() { exr_finish(&context_); }

  void require_all() const {
    int parts = 0;
    require(exr_get_count(context_, &parts));
    for (int part = 0; part < parts; ++part) {
      exr_storage_t storage = EXR_STORAGE_SCANLINE;
      require(exr_get_storage(context_, part, &storage));
      const bool tiled = storage == EXR_STORAGE_TILED || storage == EXR_STORAGE_DEEP_TILED;
      tiled ? require_tiles(part) : require_lines(part);
    }
  }

 private:
  static void require(exr_result_t result) {
    if (result != EXR_ERR_SUCCESS) throw std::runtime_error(exr_get_default_error_message(result));
  }

  void require_inside(const exr_chunk_info_t& chunk) const {
    // Neither sum can overflow: OpenEXR has checked both parts of it against the file's size.
    if (chunk.data_offset + chunk.packed_size > file_size_ ||
        chunk.sample_count_data_offset + chunk.sample_count_table_size > file_size_) {
      throw std::runtime_error("pixels end behind the end of the file");
    }
  }

  void require_lines(int part) const {
    exr_attr_box2i_t window{};
    std::int32_t lines = 1;
    require(exr_get_data_window(context_, part, &window));
    require(exr_get_scanlines_per_chunk(context_, part, &lines));
    for (std::int64_t y = window.min.y; y <= window.max.y; y += lines) {
      exr_chunk_info_t chunk{};
      require(exr_read_scanline_chunk_info(context_, part, static_cast<int>(y), &chunk));
      require_inside(chunk);
    }
  }

  void require_tiles(int part) const {
    std::int32_t levels_x = 0;
    std::int32_t levels_y = 0;
    std::uint32_t tile_width = 0;
    std::uint32_t tile_height = 0;
    exr_tile_level_mode_t mode = EXR_TILE_ONE_LEVEL;
    exr_tile_round_mode_t rounding = EXR_TILE_ROUND_DOWN;
    require(exr_get_tile_levels(context_, part, &levels_x, &levels_y));
    require(exr_get_tile_descriptor(context_, part, &tile_width, &tile_height, &mode, &rounding));
    for (int level_y = 0; level_y < levels_y; ++level_y) {
      for (int level_x = 0; level_x < levels_x; ++level_x) {
        if (mode != EXR_TILE_RIPMAP_LEVELS && level_x != level_y) continue;
        require_tiles_of_level(part, level_x, level_y);
      }
    }
  }

  void require_tiles_of_level(int part, int level_x, int level_y) const {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::int32_t tile_width = 0;
    std::int32_t tile_height = 0;
    require(exr_get_level_sizes(context_, part, level_x, level_y, &width, &height));
    require(exr_get_tile_sizes(context_, part, level_x, level_y, &tile_width, &tile_height));
    const auto count = [](int size, int tile) { return (size + std::max(tile, 1) - 1) / std::max(tile, 1); };
    for (int tile_y = 0; tile_y < count(height, tile_height); ++tile_y) {
      for (int tile_x = 0; tile_x < count(width, tile_width); ++tile_x) {
        exr_chunk_info_t chunk{};
        require(exr_read_tile_chunk_info(context_, part, tile_x, tile_y, level_x, level_y, &chunk));
        require_inside(chunk);
      }
    }
  }

  std::uint64_t file_size_;
  exr_context_t context_ = nullptr;
};

}  // namespace

void set_exr_threads(int count) {
  std::call_once(threads_were_set, [] {});
  Imf::setGlobalThreadCount(std::max(count, 0));
}

void reading(const std::string& path, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ExitStatus::resource, fmt::format("{}: not enough memory to read it", path));
  } catch (const std::exception& error) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: truncated, corrupt or unsupported EXR: {}", path,
                                                   reason(path, error.what())));
  }
}

FileStamp stamp_of(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: no such file", path));
  }
  if (error) throw Error(ExitStatus::bad_input, fmt::format("{}: cannot be read: {}", path, error.message()));
  if (!fs::is_regular_file(status)) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: not a file, expected an EXR file", path));
  }
  FileStamp stamp{fs::file_size(path, error), fs::last_write_time(path, error)};
  if (error) throw Error(ExitStatus::bad_input, fmt::format("{}: cannot be read: {}", path, error.message()));
  return stamp;
}

std::unique_ptr<Imf::MultiPartInputFile> open_exr(const std::string& path) {
  prepare_library();
  if (std::FILE* file = std::fopen(path.c_str(), "rbe")) {
    std::fclose(file);
  } else {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: cannot be read: {}", path, std::generic_category().message(errno)));
  }
  if (!Imf::isOpenExrFile(path.c_str())) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: not an EXR file", path));
  }
  return std::make_unique<Imf::MultiPartInputFile>(path.c_str());
}

std::vector<std::vector<std::string>> channel_names(const Imf::MultiPartInputFile& file) {
  std::vector<std::vector<std::string>> names(file.parts());
  for (int part = 0; part < file.parts(); ++part) {
    if (is_deep(file.header(part))) continue;
    const Imf::ChannelList& channels = file.header(part).channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
      names[part].emplace_back(channel.name());
    }
  }
  return names;
}

bool is_deep(const Imf::Header& header) {
  return header.hasType() && Imf::isDeepData(header.type());
}

bool is_tiled(const Imf::Header& header) {
  return header.hasType() ? Imf::isTiled(header.type()) : header.hasTileDescription();
}

void require_all_chunks(const std::string& path) {
  ChunkTable(path, stamp_of(path).size).require_all();
}

}  // namespace becalm::io
