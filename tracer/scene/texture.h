#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "tracer/vec.h"

namespace becalm::tracer {

/// How the numbers in an image file become reflectance.
enum class ColorSpace { linear, srgb };

struct TextureSettings {
  std::string path;
  ColorSpace space = ColorSpace::srgb;
  V2f repeat{1.0f, 1.0f};  ///< copies over the unit square of uv
  V3f scale{1.0f};
};

/// Image textures, read through OpenImageIO's texture system: tiled and MIP-mapped on demand, within a fixed
/// cache. Files are decoded to linear light before anything filters them.
class Textures {
 public:
  Textures();
  ~Textures();
  Textures(Textures&&) noexcept;
  Textures& operator=(Textures&&) noexcept;

  /// Opens the file and returns the texture's number. Throws std::runtime_error with the reason if it is not
  /// a readable image; pixels are read when they are needed.
  std::uint32_t add(const TextureSettings& settings);
  std::uint32_t count() const;

  /// Reads textures on one thread; made for each tile, since it knows the thread's part of the cache.
  class Reader {
   public:
    explicit Reader(const Textures& textures);
    /// Colour in [0,1] averaged over about `footprint_uv` (a width in uv). The file's pixels that cannot be
    /// read are black, and remembered for check().
    V3f color(std::uint32_t texture, const V2f& uv, float footprint_uv) const;

   private:
    const Textures* textures_;
    void* thread_info_;
  };

  /// Throws Error(bad_input) naming the file, if pixels could not be read since the start.
  void check() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::tracer
