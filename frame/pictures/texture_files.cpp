#include "frame/pictures/texture_files.h"

#include <Imath/half.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace becalm::pictures {
namespace {

constexpr float kCacheMegabytes = 1024.0f;

float finite_or_zero(float v) {
  return std::isfinite(v) ? v : 0.0f;
}

/// Presents any image file as three channels of linear half, so that the cache's MIP maps and filters average
/// light and not code values, or as one or three channels of float as they are. Grey is repeated.
class LinearInput : public OIIO::ImageInput {
 public:
  const char* format_name() const override { return "linear"; }

  bool open(const std::string& name, OIIO::ImageSpec& spec) override {
    const std::size_t colon = name.find(':');
    const std::string what = name.substr(0, colon);
    file_ = open_separate(name.substr(colon + 1));
    if (!file_) {
      errorfmt("{}", OIIO::geterror());
      return false;
    }
    const OIIO::ImageSpec& source = file_->spec();
    srgb_ = what == "srgb";
    half_ = srgb_ || what == "linear";
    channels_.clear();
    for (const char* channel : {"r", "g", "b", "a"}) {
      const bool wanted = what.size() == 1 ? what == channel : *channel != 'a';
      if (wanted)
        channels_.push_back(std::max(0, find_channel(source.nchannels, source.alpha_channel, channel)));
    }
    m_spec = OIIO::ImageSpec(source.width, source.height, static_cast<int>(channels_.size()),
                             half_ ? OIIO::TypeHalf : OIIO::TypeFloat);
    spec = m_spec;
    band_begin_ = band_end_ = 0;
    return true;
  }

  bool close() override {
    file_.reset();
    return true;
  }

  bool read_native_scanline(int subimage, int miplevel, int y, int /*z*/, void* data) override {
    if (subimage != 0 || miplevel != 0 || (!(y >= band_begin_ && y < band_end_) && !read_band(y)))
      return false;
    const int stride = file_->spec().nchannels;
    const float* from = band_.data() + static_cast<std::size_t>(y - band_begin_) * m_spec.width * stride;
    auto* halves = static_cast<Imath::half*>(data);
    auto* floats = static_cast<float*>(data);
    for (int x = 0; x < m_spec.width; ++x, from += stride) {
      for (const int c : channels_) {
        const float v = finite_or_zero(srgb_ ? srgb_to_linear(from[c]) : from[c]);
        if (half_) {
          *halves++ = std::clamp(v, -kLargestHalf, kLargestHalf);
        } else {
          *floats++ = v;
        }
      }
    }
    return true;
  }

 private:
  static constexpr float kLargestHalf = 65504.0f;

  /// Reads the rows of tiles, or the one scanline, that hold row y.
  bool read_band(int y) {
    const OIIO::ImageSpec& source = file_->spec();
    const int height = source.tile_height > 0 ? source.tile_height : 1;
    band_begin_ = y / height * height;
    band_end_ = std::min(band_begin_ + height, source.height);
    band_.resize(static_cast<std::size_t>(source.width) * height * source.nchannels);
    const int top = source.y + band_begin_, bottom = source.y + band_end_;
    const bool ok = source.tile_height > 0
                        ? file_->read_tiles(0, 0, source.x, source.x + source.width, top, bottom, source.z,
                                            source.z + 1, 0, source.nchannels, OIIO::TypeFloat, band_.data())
                        : file_->read_scanlines(0, 0, top, bottom, source.z, 0, source.nchannels,
                                                OIIO::TypeFloat, band_.data());
    if (!ok) {
      errorfmt("{}", file_->geterror());
      band_begin_ = band_end_ = 0;
    }
    return ok;
  }

  bool srgb_ = false;
  bool half_ = false;
  std::vector<int> channels_;  ///< of the file, those presented
  std::unique_ptr<OIIO::ImageInput> file_;
  std::vector<float> band_;
  int band_begin_ = 0;
  int band_end_ = 0;
};

OIIO::ImageInput* make_input() {
  return new LinearInput;
}

class CachedTextures : public TextureFiles {
 public:
  // One cache serves the process, as OpenImageIO means it; a private one is deleted by 2.4 through a type
  // without a virtual destructor.
  CachedTextures() : cache_(OIIO::ImageCache::create(true)), system_(OIIO::TextureSystem::create(true)) {
    cache_->attribute("max_memory_MB", kCacheMegabytes);
    cache_->attribute("autotile", 64);
    cache_->attribute("automip", 1);
  }
  ~CachedTextures() override {
    OIIO::TextureSystem::destroy(system_);
    OIIO::ImageCache::destroy(cache_);
  }
  CachedTextures(const CachedTextures&) = delete;
  CachedTextures& operator=(const CachedTextures&) = delete;

  void* open(const std::string& name, bool anew) override {
    const OIIO::ustring key(name);
    if (anew) cache_->add_file(key, make_input, nullptr, true);
    OIIO::TextureSystem::TextureHandle* handle = system_->get_texture_handle(key);
    if (handle == nullptr || !system_->good(handle)) throw std::runtime_error(system_->geterror());
    return handle;
  }

  void read(const std::string& name, const Header& size, std::span<float> pixels) override {
    const OIIO::ustring key(name);
    const bool ok = cache_->get_pixels(key, 0, 0, 0, size.width, 0, size.height, 0, 1, 0, size.channels,
                                       OIIO::TypeFloat, pixels.data());
    const std::string reason = ok ? "" : cache_->geterror();
    cache_->invalidate(key, false);
    if (!ok) throw std::runtime_error(reason);
  }

  void* thread_info() override { return system_->get_perthread_info(); }

  std::string look_up(void* texture, void* thread_info, const Lookup& at, std::span<float> values) override {
    OIIO::TextureOpt options;
    options.swrap = options.twrap = OIIO::TextureOpt::WrapPeriodic;
    options.interpmode = OIIO::TextureOpt::InterpBilinear;
    options.mipmode = OIIO::TextureOpt::MipModeAniso;
    options.anisotropic = at.anisotropy;
    const bool ok = system_->texture(static_cast<OIIO::TextureSystem::TextureHandle*>(texture),
                                     static_cast<OIIO::TextureSystem::Perthread*>(thread_info), options, at.s,
                                     at.t, at.ds_dx, at.dt_dx, at.ds_dy, at.dt_dy,
                                     static_cast<int>(values.size()), values.data());
    if (ok) return "";
    const std::string reason = system_->geterror();  // once for each file
    return reason.empty() ? "cannot be read" : reason;
  }

 private:
  OIIO::ImageCache* cache_;
  OIIO::TextureSystem* system_;
};

}  // namespace

std::unique_ptr<OIIO::ImageInput> open_separate(const std::string& path) {
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  return OIIO::ImageInput::open(path, &config);
}

std::unique_ptr<TextureFiles> make_texture_files() {
  return std::make_unique<CachedTextures>();
}

}  // namespace becalm::pictures
