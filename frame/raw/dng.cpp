#include "frame/raw/dng.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "frame/io/atomic_file.h"

namespace becalm::raw {
namespace {

/// TIFF's types of values.
enum class Type : std::uint16_t {
  byte = 1,
  ascii = 2,
  short_ = 3,
  long_ = 4,
  rational = 5,
  srational = 10,
  double_ = 12
};

/// One directory of a little-endian TIFF file, its values behind it. Tags are added in ascending order.
class Directory {
 public:
  /// Its place in the file.
  explicit Directory(std::size_t at) : at_(at) {}

  template <class T>
  void add(std::uint16_t tag, Type type, const std::vector<T>& values) {
    Entry entry{tag, type, static_cast<std::uint32_t>(values.size()), {}};
    entry.bytes.resize(values.size() * sizeof(T));
    std::memcpy(entry.bytes.data(), values.data(), entry.bytes.size());
    if (type == Type::rational || type == Type::srational) entry.count /= 2;
    entries_.push_back(std::move(entry));
  }
  void add_text(std::uint16_t tag, const std::string& text) {
    add(tag, Type::ascii, std::vector<char>(text.c_str(), text.c_str() + text.size() + 1));
  }
  void add_short(std::uint16_t tag, int value) {
    add(tag, Type::short_, std::vector{static_cast<std::uint16_t>(value)});
  }
  void add_long(std::uint16_t tag, std::size_t value) {
    add(tag, Type::long_, std::vector{static_cast<std::uint32_t>(value)});
  }
  /// Millionths, or what is left of them for large values.
  void add_rationals(std::uint16_t tag, Type type, std::span<const double> values) {
    std::vector<std::int32_t> parts;
    for (const double value : values) {
      const double denominator = std::abs(value) < 1000.0 ? 1e6 : 1.0;
      parts.push_back(static_cast<std::int32_t>(std::lround(std::clamp(value, -2e9, 2e9) * denominator)));
      parts.push_back(static_cast<std::int32_t>(denominator));
    }
    add(tag, type, parts);
  }

  std::size_t size() const {
    std::size_t sum = own_size();
    for (const Entry& entry : entries_) sum += entry.bytes.size() > 4 ? round_up(entry.bytes.size()) : 0;
    return sum;
  }

  std::vector<std::byte> bytes() const {
    std::vector<std::byte> out(size());
    std::size_t at = 0;
    const auto put = [&](const auto& value) {
      std::memcpy(out.data() + at, &value, sizeof(value));
      at += sizeof(value);
    };
    put(static_cast<std::uint16_t>(entries_.size()));
    std::size_t behind = own_size();
    for (const Entry& entry : entries_) {
      put(entry.tag);
      put(entry.type);
      put(entry.count);
      std::uint32_t place = 0;
      if (entry.bytes.size() <= 4) {
        std::memcpy(&place, entry.bytes.data(), entry.bytes.size());
      } else {
        place = static_cast<std::uint32_t>(at_ + behind);
        std::memcpy(out.data() + behind, entry.bytes.data(), entry.bytes.size());
        behind += round_up(entry.bytes.size());
      }
      put(place);
    }
    return out;
  }

 private:
  struct Entry {
    std::uint16_t tag;
    Type type;
    std::uint32_t count;
    std::vector<std::byte> bytes;
  };
  static std::size_t round_up(std::size_t size) { return (size + 7) / 8 * 8; }
  /// Without the values behind it.
  std::size_t own_size() const { return round_up(2 + 12 * entries_.size() + 4); }

  std::size_t at_;
  std::vector<Entry> entries_;
};

/// EXIF's number of what turns a picture upright.
int orientation(int flip) {
  constexpr int numbers[8] = {1, 2, 4, 3, 5, 8, 6, 7};
  return numbers[flip & 7];
}

constexpr std::size_t kHeaderBytes = 8;

Directory exif(const Info& info, std::size_t at) {
  Directory d(at);
  if (info.shutter_s > 0) d.add_rationals(33434, Type::rational, std::array{info.shutter_s});
  if (info.f_number > 0) d.add_rationals(33437, Type::rational, std::array{info.f_number});
  if (info.iso > 0) d.add_short(34855, static_cast<int>(std::clamp(info.iso, 1.0, 65535.0)));
  return d;
}

Directory directory(const Info& info, const DngSamples& samples, std::size_t exif_at, std::size_t pixels_at) {
  const auto rationals = [](const std::array<float, 9>& values) {
    return std::vector<double>(values.begin(), values.end());
  };
  std::vector<double> neutral;
  for (const float factor : info.white_balance) neutral.push_back(factor > 0.0f ? 1.0 / factor : 1.0);
  const auto cells = std::ptrdiff_t{info.cfa.period} * info.cfa.period;
  Directory d(kHeaderBytes);
  d.add_long(254, 0);  // NewSubfileType: the picture itself
  d.add_long(256, static_cast<std::size_t>(info.width));
  d.add_long(257, static_cast<std::size_t>(info.height));
  d.add_short(258, 16);     // BitsPerSample
  d.add_short(259, 1);      // Compression: none
  d.add_short(262, 32803);  // PhotometricInterpretation: a mosaic
  d.add_text(271, info.make.empty() ? "becalm" : info.make);
  d.add_text(272, info.model.empty() ? "mosaic" : info.model);
  d.add_long(273, pixels_at);  // StripOffsets
  d.add_short(274, orientation(info.flip));
  d.add_short(277, 1);  // SamplesPerPixel
  d.add_long(278, static_cast<std::size_t>(info.height));
  d.add_long(279, samples.values.size_bytes());
  d.add_short(284, 1);  // PlanarConfiguration
  d.add_text(305, "becalm");
  d.add(33421, Type::short_, std::vector<std::uint16_t>(2, static_cast<std::uint16_t>(info.cfa.period)));
  d.add(33422, Type::byte,
        std::vector<std::uint8_t>(info.cfa.colors.begin(), info.cfa.colors.begin() + cells));
  d.add_long(34665, exif_at);
  d.add(50706, Type::byte, std::vector<std::uint8_t>{1, 4, 0, 0});  // DNGVersion
  d.add(50707, Type::byte, std::vector<std::uint8_t>{1, 1, 0, 0});  // DNGBackwardVersion
  d.add_text(50708, info.make + " " + info.model);                  // UniqueCameraModel
  d.add_short(50714, samples.black);
  d.add_long(50717, samples.white);
  if (info.xyz_to_camera != std::array<float, 9>{})
    d.add_rationals(50721, Type::srational, rationals(info.xyz_to_camera));
  d.add_rationals(50728, Type::rational, neutral);  // AsShotNeutral
  d.add_short(50778, 21);                           // CalibrationIlluminant1: D65
  if (info.noise) d.add(51041, Type::double_, std::vector<double>{info.noise->a, info.noise->b});
  return d;
}

/// So that noise below black is kept.
constexpr std::uint16_t kDngBlack = 4096;

/// Samples of 16 bits: black is kDngBlack and white 65535, to which values above it are cut.
std::vector<std::uint16_t> quantized(const Mosaic& mosaic) {
  std::vector<std::uint16_t> values(mosaic.samples.pixel_count());
  const auto samples = mosaic.samples.data();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float value = static_cast<float>(kDngBlack) + samples[i] * static_cast<float>(65535 - kDngBlack);
    values[i] = static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0f, 65535.0f)));
  }
  return values;
}

}  // namespace

std::vector<std::byte> dng_bytes(const Info& info, const DngSamples& samples) {
  const std::size_t exif_at = kHeaderBytes + directory(info, samples, 0, 0).size();
  const Directory of_exif = exif(info, exif_at);
  const std::size_t pixels_at = exif_at + of_exif.size();
  std::vector<std::byte> bytes;
  for (const int value : {0x49, 0x49, 42, 0, static_cast<int>(kHeaderBytes), 0, 0, 0})
    bytes.push_back(static_cast<std::byte>(value));
  for (const Directory& part : {directory(info, samples, exif_at, pixels_at), of_exif}) {
    const std::vector<std::byte> of_part = part.bytes();
    bytes.insert(bytes.end(), of_part.begin(), of_part.end());
  }
  bytes.resize(pixels_at + samples.values.size_bytes());
  std::memcpy(bytes.data() + pixels_at, samples.values.data(), samples.values.size_bytes());
  return bytes;
}

void write_dng(const std::string& path, const Mosaic& mosaic, const Info& info) {
  const std::vector<std::uint16_t> values = quantized(mosaic);
  const std::vector<std::byte> bytes =
      dng_bytes(info, {.values = values, .black = kDngBlack, .white = 65535});
  io::AtomicFile file(path);
  file.write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  file.commit();
}

}  // namespace becalm::raw
