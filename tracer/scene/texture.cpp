#include "tracer/scene/texture.h"

#include <Imath/half.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>

#include <atomic>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "frame/error.h"

namespace becalm::tracer {

namespace {

constexpr float kCacheMegabytes = 1024.0f;

float srgb_to_linear(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// Presents any image file as three channels of linear half, so that the cache's MIP maps and filters average
/// light and not code values. Grey is repeated, alpha left out.
class LinearInput : public OIIO::ImageInput {
 public:
  explicit LinearInput(ColorSpace space) : space_(space) {}

  /// The cache knows the file as `prefix:path`, since one file may be used in both spaces.
  static constexpr std::string_view prefix(ColorSpace space) {
    return space == ColorSpace::srgb ? "srgb:" : "linear:";
  }

  const char* format_name() const override { return "linear"; }

  bool open(const std::string& name, OIIO::ImageSpec& spec) override {
    file_ = OIIO::ImageInput::open(name.substr(prefix(space_).size()));
    if (!file_) {
      errorfmt("{}", OIIO::geterror());
      return false;
    }
    const OIIO::ImageSpec& source = file_->spec();
    m_spec = OIIO::ImageSpec(source.width, source.height, 3, OIIO::TypeHalf);
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
    const int channels = file_->spec().nchannels;
    const float* from = band_.data() + static_cast<std::size_t>(y - band_begin_) * m_spec.width * channels;
    auto* to = static_cast<Imath::half*>(data);
    for (int x = 0; x < m_spec.width; ++x, from += channels, to += 3) {
      for (int c = 0; c < 3; ++c) {
        const float v = channels >= 3 ? from[c] : from[0];
        to[c] = space_ == ColorSpace::srgb ? srgb_to_linear(v) : v;
      }
    }
    return true;
  }

 private:
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

  ColorSpace space_;
  std::unique_ptr<OIIO::ImageInput> file_;
  std::vector<float> band_;
  int band_begin_ = 0;
  int band_end_ = 0;
};

OIIO::ImageInput* make_linear_input() {
  return new LinearInput(ColorSpace::linear);
}
OIIO::ImageInput* make_srgb_input() {
  return new LinearInput(ColorSpace::srgb);
}

}  // namespace

struct Textures::State {
  struct Entry {
    OIIO::TextureSystem::TextureHandle* handle;
    TextureSettings settings;
  };

  // One cache serves the process, as OpenImageIO means it; a private one is deleted by 2.4 through a type
  // without a virtual destructor.
  State() : cache(OIIO::ImageCache::create(true)), system(OIIO::TextureSystem::create(true)) {
    cache->attribute("max_memory_MB", kCacheMegabytes);
    cache->attribute("autotile", 64);
    cache->attribute("automip", 1);
  }
  ~State() {
    OIIO::TextureSystem::destroy(system);
    OIIO::ImageCache::destroy(cache);
  }

  OIIO::ImageCache* cache;
  OIIO::TextureSystem* system;
  std::vector<Entry> entries;
  std::atomic<bool> failed{false};
  std::mutex failure_mutex;
  std::string failure;
};

Textures::Textures() = default;
Textures::~Textures() = default;
Textures::Textures(Textures&&) noexcept = default;
Textures& Textures::operator=(Textures&&) noexcept = default;

std::uint32_t Textures::count() const {
  return state_ ? static_cast<std::uint32_t>(state_->entries.size()) : 0;
}

std::uint32_t Textures::add(const TextureSettings& settings) {
  if (!OIIO::ImageInput::open(settings.path)) throw std::runtime_error(OIIO::geterror());
  if (!state_) state_ = std::make_unique<State>();
  const OIIO::ustring name(std::string(LinearInput::prefix(settings.space)) + settings.path);
  // Read anew even if another scene of this process knows the file, which may have changed since.
  state_->cache->add_file(name, settings.space == ColorSpace::srgb ? make_srgb_input : make_linear_input,
                          nullptr, true);
  OIIO::TextureSystem::TextureHandle* handle = state_->system->get_texture_handle(name);
  if (handle == nullptr || !state_->system->good(handle))
    throw std::runtime_error(state_->system->geterror());
  state_->entries.push_back({handle, settings});
  return count() - 1;
}

void Textures::check() const {
  if (state_ && state_->failed) throw Error(ExitStatus::bad_input, state_->failure);
}

Textures::Reader::Reader(const Textures& textures)
    : textures_(&textures),
      thread_info_(textures.state_ ? textures.state_->system->get_perthread_info() : nullptr) {}

V3f Textures::Reader::color(std::uint32_t texture, const V2f& uv, float footprint_uv) const {
  State& state = *textures_->state_;
  const State::Entry& entry = state.entries[texture];
  const V2f& repeat = entry.settings.repeat;
  OIIO::TextureOpt options;
  options.swrap = options.twrap = OIIO::TextureOpt::WrapPeriodic;
  options.interpmode = OIIO::TextureOpt::InterpBilinear;
  options.mipmode = OIIO::TextureOpt::MipModeTrilinear;
  V3f color(0.0f);
  // OpenImageIO's t runs down the picture, v runs up.
  const bool ok = state.system->texture(
      entry.handle, static_cast<OIIO::TextureSystem::Perthread*>(thread_info_), options, uv.x * repeat.x,
      1.0f - uv.y * repeat.y, footprint_uv * repeat.x, 0.0f, 0.0f, footprint_uv * repeat.y, 3, &color.x);
  if (!ok) {
    const std::lock_guard lock(state.failure_mutex);
    if (!state.failed) {
      std::string reason = state.system->geterror();
      std::replace(reason.begin(), reason.end(), '\n', ' ');
      state.failure = entry.settings.path + ": " + reason;
    }
    state.failed = true;
    return V3f(0.0f);
  }
  color *= entry.settings.scale;
  for (float* c = &color.x; c != &color.x + 3; ++c) *c = std::clamp(*c, 0.0f, 1.0f);
  return color;
}

}  // namespace becalm::tracer
