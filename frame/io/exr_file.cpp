#include "frame/io/exr_file.h"

#include <OpenEXR/IexErrnoExc.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>

#include "frame/error.h"
#include "frame/io/exr_bytes.h"
#include "frame/io/jitter_text.h"
#include "frame/io/read_error.h"
#include "frame/regular_file.h"

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

/// Whether OpenEXR throws this for what the system lacks, and not for what is in the file.
bool is_of_system(const std::exception& error) {
  const auto is_any_of = [&]<class... Kinds>() {
    return (... || (dynamic_cast<const Kinds*>(&error) != nullptr));
  };
  return is_any_of
      .template operator()<Iex::EioExc, Iex::EmfileExc, Iex::EnfileExc, Iex::EagainExc, Iex::EnomemExc,
                           Iex::EaccesExc, Iex::EpermExc, Iex::EstaleExc, Iex::EtimedoutExc>();
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

constexpr const char* kExpected = "an EXR file";

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
  } catch (const std::system_error& error) {
    fail_to_read(path, error.code());
  } catch (const std::exception& error) {
    if (is_of_system(error)) {
      throw ReadError(ExitStatus::resource,
                      fmt::format("{}: cannot be read: {}", path, reason(path, error.what())));
    }
    throw Error(ExitStatus::bad_input, fmt::format("{}: truncated, corrupt or unsupported EXR: {}", path,
                                                   reason(path, error.what())));
  }
}

FileStamp stamp_of(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    const bool is_glob = path.find('*') != std::string::npos;
    throw Error(ExitStatus::bad_input, fmt::format("{}: no such file{}", path,
                                                   is_glob ? "; the frame number is written as ####" : ""));
  }
  if (error) fail_to_read(path, error);
  refuse_other_than_file(path, kExpected);
  FileStamp stamp{fs::file_size(path, error), fs::last_write_time(path, error)};
  if (error) fail_to_read(path, error);
  return stamp;
}

std::unique_ptr<Imf::MultiPartInputFile> open_exr(const std::string& path) {
  prepare_library();
  refuse_other_than_file(path, kExpected);
  const ExrBytes file(path);
  if (!file.is_exr()) throw Error(ExitStatus::bad_input, fmt::format("{}: not an EXR file", path));
  file.headers_end();  // throws before OpenEXR allocates what a damaged header asks for
  return std::make_unique<Imf::MultiPartInputFile>(path.c_str());
}

std::vector<PartChannels> part_channels(const Imf::MultiPartInputFile& file) {
  std::vector<PartChannels> parts(file.parts());
  for (int i = 0; i < file.parts(); ++i) {
    const Imf::Header& header = file.header(i);
    if (is_deep(header)) continue;
    PartChannels& part = parts[i];
    part.data_window = header.dataWindow();
    if (file.parts() > 1 && header.hasName()) part.name = header.name();
    if (header.hasView()) part.view = header.view();
    if (Imf::hasMultiView(header)) part.multi_view = Imf::multiView(header);
    const auto* samples = header.findTypedAttribute<Imf::IntAttribute>("samplesPerPixel");
    if (samples != nullptr) part.samples_per_pixel = samples->value();
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
      part.channels.emplace_back(channel.name());
      if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
        part.subsampled.insert(channel.name());
    }
  }
  return parts;
}

bool is_deep(const Imf::Header& header) {
  return header.hasType() && Imf::isDeepData(header.type());
}

void require_flat(const std::string& path, const Imf::MultiPartInputFile& file) {
  for (int part = 0; part < file.parts(); ++part) {
    if (!is_deep(file.header(part))) return;
  }
  throw Error(ExitStatus::bad_input, fmt::format("{}: a deep image, expected flat pixels", path));
}

bool is_tiled(const Imf::Header& header) {
  return header.hasType() ? Imf::isTiled(header.type()) : header.hasTileDescription();
}

std::string text_attribute(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute == nullptr ? std::string() : attribute->value();
}

bool is_checkerboard(const Imf::MultiPartInputFile& file) {
  return parse_checkerboard(text_attribute(file.header(0), kCheckerboardAttribute), Imath::V2i(0))
      .has_value();
}

}  // namespace becalm::io
