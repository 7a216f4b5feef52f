#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Picture files of any format, read and written by OpenImageIO. Loading that library takes 0.27 s and
/// 120 MiB, since it brings 250 others, so the first call of pictures::library() loads it.
namespace becalm::pictures {

/// The channel called `name` ("r", "g", "b" or "a") of a file with so many channels; -1 if there is none.
/// Grey serves as r, g and b.
inline int find_channel(int channels, int alpha_channel, std::string_view name) {
  if (name == "a") return alpha_channel;
  return channels >= 3 ? static_cast<int>(std::string_view("rgb").find(name)) : 0;
}

/// The linear value of a code in [0,1] (IEC 61966-2-1).
inline float srgb_to_linear(float code) {
  return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
}

struct Header {
  int width = 0;
  int height = 0;
  int channels = 0;
  int alpha_channel = -1;      ///< -1: none
  bool float_samples = false;  ///< half, float or double; the others are integers
};

/// Whether colours come multiplied by their alpha.
enum class Alpha { multiplied, separate };

/// An open file.
class Picture {
 public:
  virtual ~Picture() = default;
  virtual const Header& header() const = 0;
  /// All channels of all pixels, row by row from the top left: width * height * channels values, not
  /// converted to linear light; unsigned integers become [0,1]. Throws std::runtime_error with the reason if
  /// they cannot be read.
  virtual void read(std::span<float> pixels) = 0;
};

/// Where a texture is read: s and t count pictures, t downwards; the footprint is the parallelogram of the
/// differences along the image's x and y.
struct Lookup {
  float s, t;
  float ds_dx, dt_dx;
  float ds_dy, dt_dy;
  int anisotropy;
};

/// Files as textures that repeat, read by tiles and MIP-mapped on demand within a cache of 1 GiB. A texture's
/// name is `USE:PATH`. USE is srgb, which decodes colours to linear light before anything filters them, or
/// linear (both as half and grey repeated); data (three numbers as they are); or the channel r, g, b or a.
/// What is not finite in a file counts as 0. May be called from any thread.
class TextureFiles {
 public:
  virtual ~TextureFiles() = default;
  /// A handle for look_up. With `anew`, the file is read again even if it was known. Throws
  /// std::runtime_error with the reason if it cannot be opened.
  virtual void* open(const std::string& name, bool anew) = 0;
  /// Reads all pixels, without keeping them in the cache. Throws std::runtime_error with the reason.
  virtual void read(const std::string& name, const Header& size, std::span<float> pixels) = 0;
  /// The thread's part of the cache.
  virtual void* thread_info() = 0;
  /// Sets one value per channel. If the pixels cannot be read, returns the reason, else nothing.
  virtual std::string look_up(void* texture, void* thread_info, const Lookup& at,
                              std::span<float> values) = 0;
};

/// Which software made the picture, as a text chunk of PNG has it.
inline constexpr std::string_view kPngMark{"Software\0becalm", 15};

class Library {
 public:
  virtual ~Library() = default;
  /// Throws std::runtime_error with the reason if the file cannot be opened, is a volume or has deep pixels.
  virtual std::unique_ptr<Picture> open(const std::string& path, Alpha alpha) = 0;
  virtual std::unique_ptr<TextureFiles> texture_files() = 0;
  /// 8-bit RGB as the bytes of a PNG file, with kPngMark among its first ones. Throws std::runtime_error with
  /// the reason.
  virtual std::vector<unsigned char> png_bytes(int width, int height, std::span<const std::uint8_t> rgb) = 0;
};

/// Throws Error(resource) if the library cannot be loaded.
Library& library();

}  // namespace becalm::pictures
