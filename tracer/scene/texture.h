#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "tracer/math/picture_lookup.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// How the numbers in an image file become reflectance.
enum class ColorSpace { linear, srgb };

/// Which of the file's channels a texture gives: colours (grey is repeated), three numbers as they are
/// (normal maps), or one channel as it is.
enum class TextureContent { color, data, r, g, b, a };

struct TextureSettings {
  std::string path;
  std::optional<ColorSpace> space = std::nullopt;  ///< of colours; unset: linear for float samples, else srgb
  PicturePlacement placement{};
  V3f scale{1.0f};  ///< of what is read; its x for one channel
  TextureContent content = TextureContent::color;
};

/// A place on a texture: uv, and how uv changes from one sample's ray to the next along the picture's x and y
/// (see ray_differential.h). What is read is averaged over the parallelogram of the two.
struct TexturePoint {
  V2f uv{0.0f};
  V2f duv_dx{0.0f};
  V2f duv_dy{0.0f};
};

/// Factor of the pixel's differentials for the lookups of one of `spp` samples: spp^(-1/2), at least
/// kLeastFootprintScale, 1 for spp < 1. The n samples of a pixel stand n^(-1/2) pixels apart, so lookups of
/// that width together cover the pixel once: wider ones would blur beyond the pixel filter, narrower ones
/// would leave gaps and alias. As a bias of the MIP level that is -0.5 log2(n): Yang, Liu and Salvi, "A
/// Survey of Temporal Antialiasing Techniques", 2020, section 3.
float footprint_scale(int spp);

/// From 1024 samples on lookups get no sharper: what they leave is below the pixel filter's own resolution,
/// and finer levels cost memory.
inline constexpr float kLeastFootprintScale = 1.0f / 32.0f;

/// Image textures. Those that make_resident() has read are looked up in memory; the others are read through
/// OpenImageIO's texture system, tiled and MIP-mapped on demand within a fixed cache, which is several times
/// slower. Files are decoded to linear light before anything filters them; what is not finite in them counts
/// as 0.
class Textures {
 public:
  Textures();
  ~Textures();
  Textures(Textures&&) noexcept;
  Textures& operator=(Textures&&) noexcept;

  /// Opens the file and returns the texture's number. Throws std::runtime_error with the reason if it is not
  /// a readable image or has no such channel; pixels are read when they are needed.
  std::uint32_t add(const TextureSettings& settings);

  /// Reads those textures in parallel, in the order in which they were added, as long as they fit into so
  /// many bytes. Throws Error(bad_input) naming the file whose pixels cannot be read.
  void make_resident(const std::set<std::uint32_t>& wanted, std::size_t most_bytes);
  std::size_t resident_bytes() const;

  /// Reads textures on one thread; made for each tile, since it knows the thread's part of the cache. The
  /// file's pixels that cannot be read are 0, and remembered for check(). uv may be any number; what is not
  /// finite counts as 0, and as a footprint of the whole picture.
  class Reader {
   public:
    explicit Reader(const Textures& textures);
    /// Of a texture of colours: in [0,1].
    V3f color(std::uint32_t texture, const TexturePoint& point) const;
    /// Of a texture of data: as the file has it, times the scale.
    V3f data(std::uint32_t texture, const TexturePoint& point) const;
    /// Of a texture of one channel: as the file has it, times the scale.
    float scalar(std::uint32_t texture, const TexturePoint& point) const;
    /// Width and height of a texel in uv.
    V2f texel(std::uint32_t texture) const;

   private:
    void read(std::uint32_t texture, const TexturePoint& point, int channels, float* values) const;

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
