#include "tracer/scene/texture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

#include "frame/error.h"
#include "frame/pictures/pictures.h"
#include "tracer/math/picture_lookup.h"
#include "tracer/scene/image_channel.h"
#include "tracer/scene/mip_texture.h"

namespace becalm::tracer {

namespace {

/// Largest difference of an image's numbers at which it is stored as steps between them: beyond it, one
/// bright pixel would cost all others their precision.
constexpr float kWidestRange = 16.0f;

/// Footprints are limited to one picture's width: everything is averaged there.
constexpr float kWholePicture = 1.0f;

/// The USE of pictures::TextureFiles: one file may be used in several ways.
std::string_view use_of(const TextureSettings& settings, const pictures::Header& header) {
  constexpr std::string_view of_content[] = {"linear", "data", "r", "g", "b", "a"};
  const ColorSpace usual_space = header.float_samples ? ColorSpace::linear : ColorSpace::srgb;
  const bool coded =
      settings.content == TextureContent::color && settings.space.value_or(usual_space) == ColorSpace::srgb;
  return coded ? "srgb" : of_content[static_cast<std::size_t>(settings.content)];
}

int channels_of(const TextureSettings& settings) {
  return settings.content == TextureContent::color || settings.content == TextureContent::data ? 3 : 1;
}

std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

}  // namespace

struct Textures::State {
  struct Entry {
    void* handle;  ///< of files
    TextureSettings settings;
    std::string name;  ///< as files knows it
    V2f texel;
    int width, height;
    std::shared_ptr<const MipTexture> resident = nullptr;  ///< shared by entries of one name
  };

  std::unique_ptr<pictures::TextureFiles> files = pictures::library().texture_files();
  std::vector<Entry> entries;
  std::atomic<bool> failed{false};
  std::mutex failure_mutex;
  std::string failure;
};

Textures::Textures() = default;
Textures::~Textures() = default;
Textures::Textures(Textures&&) noexcept = default;
Textures& Textures::operator=(Textures&&) noexcept = default;

std::uint32_t Textures::add(const TextureSettings& settings) {
  const std::unique_ptr<pictures::Picture> file =
      pictures::library().open(settings.path, pictures::Alpha::separate);
  const pictures::Header& header = file->header();
  const std::string_view use = use_of(settings, header);
  if (use.size() == 1) require_channel(header, use);
  if (!state_) state_ = std::make_unique<State>();
  const std::string name = std::string(use) + ":" + settings.path;
  const bool known = std::any_of(state_->entries.begin(), state_->entries.end(),
                                 [&](const State::Entry& entry) { return entry.name == name; });
  // Read anew even if another scene of this process knows the file, which may have changed since.
  void* handle = state_->files->open(name, /*anew=*/!known);
  const V2f texel = V2f(1.0f) / (V2f(static_cast<float>(header.width), static_cast<float>(header.height)) *
                                 settings.placement.repeat);
  state_->entries.push_back(
      {handle, settings, name, V2f(std::abs(texel.x), std::abs(texel.y)), header.width, header.height});
  return static_cast<std::uint32_t>(state_->entries.size() - 1);
}

void Textures::make_resident(const std::set<std::uint32_t>& wanted, std::size_t most_bytes) {
  std::vector<State::Entry*> chosen;
  std::size_t sum = 0;
  for (const std::uint32_t texture : wanted) {
    State::Entry& entry = state_->entries[texture];
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
    try {
      const pictures::Header size{.width = entry.width, .height = entry.height, .channels = channels};
      state_->files->read(entry.name, size, texels);
    } catch (const std::runtime_error& error) {
      errors[i] = entry.settings.path + ": " + one_line(error.what());
      return;
    }
    const auto [least, largest] = std::ranges::minmax(texels);
    if (largest - least <= kWidestRange)
      entry.resident = std::make_shared<MipTexture>(entry.width, entry.height, channels, texels);
  });
  for (const std::string& error : errors) {
    if (!error.empty()) throw Error(ExitStatus::bad_input, error);
  }
  for (const std::uint32_t texture : wanted) {
    State::Entry& entry = state_->entries[texture];
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
    : textures_(&textures), thread_info_(textures.state_ ? textures.state_->files->thread_info() : nullptr) {}

void Textures::Reader::read(std::uint32_t texture, const TexturePoint& point, int channels,
                            float* values) const {
  State& state = *textures_->state_;
  const State::Entry& entry = state.entries[texture];
  const PicturePlacement& placement = entry.settings.placement;
  const V2f& repeat = placement.repeat;
  const auto limit = [](float v) {
    return std::isnan(v) ? kWholePicture : std::clamp(v, -kWholePicture, kWholePicture);
  };
  const V2f st = picture_point(placement(point.uv));
  const V2f st_dx(limit(point.duv_dx.x * repeat.x), limit(-point.duv_dx.y * repeat.y));
  const V2f st_dy(limit(point.duv_dy.x * repeat.x), limit(-point.duv_dy.y * repeat.y));
  if (entry.resident) {
    entry.resident->read(st, st_dx, st_dy, values);
    return;
  }
  const pictures::Lookup at{.s = st.x,
                            .t = st.y,
                            .ds_dx = st_dx.x,
                            .dt_dx = st_dx.y,
                            .ds_dy = st_dy.x,
                            .dt_dy = st_dy.y,
                            .anisotropy = MipTexture::kAnisotropy};
  const std::string reason =
      state.files->look_up(entry.handle, thread_info_, at, {values, static_cast<std::size_t>(channels)});
  if (reason.empty()) return;
  std::fill(values, values + channels, 0.0f);
  const std::lock_guard lock(state.failure_mutex);
  if (!state.failed) {
    state.failure = entry.settings.path + ": " + one_line(reason);
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
