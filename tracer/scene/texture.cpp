#include "tracer/scene/texture.h"

#include <Imath/half.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

#include "frame/error.h"
#include "tracer/math/picture_lookup.h"
#include "tracer/scene/image_channel.h"
#include "tracer/scene/mip_texture.h"

namespace becalm::tracer {

namespace {

constexpr float kCacheMegabytes = 1024.0f;

float srgb_to_linear(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// Largest difference of an image's numbers at which it is stored as steps between them: beyond it, one
/// bright pixel would cost all others their precision.
constexpr float kWidestRange = 16.0f;

/// Footprints are limited to one picture's width: everything is averaged there.
constexpr float kWholePicture = 1.0f;

/// The cache knows a file as `PREFIX:path`, since one file may be used in several ways.
std::string_view prefix(const TextureSettings& settings) {
  constexpr std::string_view of_content[] = {"linear", "data", "r", "g", "b", "a"};
  const bool coded = settings.content == TextureContent::color && settings.space == ColorSpace::srgb;
  return coded ? "srgb" : of_content[static_cast<std::size_t>(settings.content)];
}

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
    file_ = open_image(name.substr(colon + 1));
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
      if (wanted) channels_.push_back(std::max(0, find_channel(source, channel)));
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

int channels_of(const TextureSettings& settings) {
  return settings.content == TextureContent::color || settings.content == TextureContent::data ? 3 : 1;
}

std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

OIIO::ImageInput* make_input() {
  return new LinearInput;
}

}  // namespace

struct Textures::State {
  struct Entry {
    OIIO::TextureSystem::TextureHandle* handle;
    TextureSettings settings;
    OIIO::ustring name;
    V2f texel;
    int width, height;
    std::shared_ptr<const MipTexture> resident = nullptr;  ///< shared by entries of one name
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
  const std::unique_ptr<OIIO::ImageInput> file = open_flat_image(settings.path);
  const std::string_view what = prefix(settings);
  if (what.size() == 1) require_channel(file->spec(), what);
  if (!state_) state_ = std::make_unique<State>();
  const OIIO::ustring name(std::string(what) + ":" + settings.path);
  const bool known = std::any_of(state_->entries.begin(), state_->entries.end(),
                                 [&](const State::Entry& entry) { return entry.name == name; });
  // Read anew even if another scene of this process knows the file, which may have changed since.
  if (!known) state_->cache->add_file(name, make_input, nullptr, true);
  OIIO::TextureSystem::TextureHandle* handle = state_->system->get_texture_handle(name);
  if (handle == nullptr || !state_->system->good(handle))
    throw std::runtime_error(state_->system->geterror());
  const V2f texel =
      V2f(1.0f) / (V2f(static_cast<float>(file->spec().width), static_cast<float>(file->spec().height)) *
                   settings.repeat);
  state_->entries.push_back({handle, settings, name, V2f(std::abs(texel.x), std::abs(texel.y)),
                             file->spec().width, file->spec().height});
  return count() - 1;
}

void Textures::make_resident(std::size_t most_bytes) {
  if (!state_) return;
  std::vector<State::Entry*> chosen;
  std::size_t sum = 0;
  for (State::Entry& entry : state_->entries) {
    const auto same = [&](const State::Entry* other) { return other->name == entry.name; };
    if (std::ranges::any_of(chosen, same)) continue;
    const std::size_t bytes = MipTexture::bytes(entry.width, entry.height, channels_of(entry.settings));
    if (sum + bytes > most_bytes) continue;
    sum += bytes;
    chosen.push_back(&entry);
  }
  std::vector<std::string> errors(chosen.size());
  tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
    State::Entry& entry = *chosen[i];
    const int channels = channels_of(entry.settings);
    std::vector<float> texels(static_cast<std::size_t>(entry.width) * entry.height * channels);
    if (state_->cache->get_pixels(entry.name, 0, 0, 0, entry.width, 0, entry.height, 0, 1, 0, channels,
                                  OIIO::TypeFloat, texels.data())) {
      const auto [least, largest] = std::ranges::minmax(texels);
      if (largest - least <= kWidestRange)
        entry.resident = std::make_shared<MipTexture>(entry.width, entry.height, channels, texels);
    } else {
      errors[i] = entry.settings.path + ": " + one_line(state_->cache->geterror());
    }
    state_->cache->invalidate(entry.name, false);
  });
  for (const std::string& error : errors) {
    if (!error.empty()) throw Error(ExitStatus::bad_input, error);
  }
  for (State::Entry& entry : state_->entries) {
    for (const State::Entry* other : chosen) {
      if (other->name == entry.name) entry.resident = other->resident;
    }
  }
}

std::size_t Textures::resident_bytes() const {
  std::set<const MipTexture*> counted;
  std::size_t sum = 0;
  for (const State::Entry& entry : state_ ? state_->entries : std::vector<State::Entry>()) {
    if (entry.resident && counted.insert(entry.resident.get()).second)
      sum += MipTexture::bytes(entry.width, entry.height, channels_of(entry.settings));
  }
  return sum;
}

void Textures::check() const {
  if (state_ && state_->failed) throw Error(ExitStatus::bad_input, state_->failure);
}

Textures::Reader::Reader(const Textures& textures)
    : textures_(&textures),
      thread_info_(textures.state_ ? textures.state_->system->get_perthread_info() : nullptr) {}

void Textures::Reader::read(std::uint32_t texture, const TexturePoint& point, int channels,
                            float* values) const {
  State& state = *textures_->state_;
  const State::Entry& entry = state.entries[texture];
  const V2f& repeat = entry.settings.repeat;
  const auto limit = [](float v) {
    return std::isnan(v) ? kWholePicture : std::clamp(v, -kWholePicture, kWholePicture);
  };
  const V2f st = picture_point(point.uv, repeat);
  const V2f st_dx(limit(point.duv_dx.x * repeat.x), limit(-point.duv_dx.y * repeat.y));
  const V2f st_dy(limit(point.duv_dy.x * repeat.x), limit(-point.duv_dy.y * repeat.y));
  if (entry.resident) {
    entry.resident->read(st, st_dx, st_dy, values);
    return;
  }
  OIIO::TextureOpt options;
  options.swrap = options.twrap = OIIO::TextureOpt::WrapPeriodic;
  options.interpmode = OIIO::TextureOpt::InterpBilinear;
  options.mipmode = OIIO::TextureOpt::MipModeAniso;
  options.anisotropic = MipTexture::kAnisotropy;
  const bool ok =
      state.system->texture(entry.handle, static_cast<OIIO::TextureSystem::Perthread*>(thread_info_), options,
                            st.x, st.y, st_dx.x, st_dx.y, st_dy.x, st_dy.y, channels, values);
  if (ok) return;
  std::fill(values, values + channels, 0.0f);
  const std::lock_guard lock(state.failure_mutex);
  if (!state.failed) {
    state.failure = entry.settings.path + ": " + one_line(state.system->geterror());
  }
  state.failed = true;
}

V3f Textures::Reader::color(std::uint32_t texture, const TexturePoint& point) const {
  V3f color = data(texture, point);
  for (float* c = &color.x; c != &color.x + 3; ++c) *c = std::clamp(*c, 0.0f, 1.0f);
  return color;
}

V3f Textures::Reader::data(std::uint32_t texture, const TexturePoint& point) const {
  V3f value(0.0f);
  read(texture, point, 3, &value.x);
  return value * textures_->state_->entries[texture].settings.scale;
}

float Textures::Reader::scalar(std::uint32_t texture, const TexturePoint& point) const {
  float value = 0.0f;
  read(texture, point, 1, &value);
  return value * textures_->state_->entries[texture].settings.scale.x;
}

V2f Textures::Reader::texel(std::uint32_t texture) const {
  return textures_->state_->entries[texture].texel;
}

float footprint_scale(int spp) {
  return std::max(kLeastFootprintScale, 1.0f / std::sqrt(static_cast<float>(std::max(1, spp))));
}

}  // namespace becalm::tracer
