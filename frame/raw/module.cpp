// The library of raw.h.

#include <libraw/libraw.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "frame/raw/raw.h"

namespace becalm::raw {
namespace {

void check(int result) {
  // LibRaw's text for all of it is 'Input/output error'.
  if (result == LIBRAW_IO_ERROR) throw std::runtime_error("it is truncated, or cannot be read");
  if (result != LIBRAW_SUCCESS) throw std::runtime_error(libraw_strerror(result));
}

/// XYZ (D65) to linear Rec. 709.
constexpr double kRec709[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                  {-0.9692660, 1.8760108, 0.0415560},
                                  {0.0556434, -0.2040259, 1.0572252}};

struct Matrix {
  double m[3][3];
};

Matrix inverse(const Matrix& a) {
  Matrix r{};
  double determinant = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int i1 = (j + 1) % 3, i2 = (j + 2) % 3, j1 = (i + 1) % 3, j2 = (i + 2) % 3;
      r.m[i][j] = a.m[i1][j1] * a.m[i2][j2] - a.m[i1][j2] * a.m[i2][j1];
    }
  }
  for (int k = 0; k < 3; ++k) determinant += a.m[0][k] * r.m[k][0];
  for (auto& row : r.m) {
    for (double& value : row) value = determinant != 0.0 ? value / determinant : 0.0;
  }
  return r;
}

/// What is told of each tag before LibRaw reads it: DNG's NoiseProfile, which LibRaw itself does not keep.
struct Tags {
  std::vector<double> noise_profile;
  bool pattern_is_6x6 = false;
  std::string refusal;  ///< why the file is not to be read, if so

  static void found(void* tags, int tag, int type, int length, unsigned order, void* stream, INT64) {
    auto& self = *static_cast<Tags*>(tags);
    auto& in = *static_cast<LibRaw_abstract_datastream*>(stream);
    switch (tag & 0xffff) {
      case 33421:  // CFARepeatPatternDim
        self.read_pattern_size(in, order);
        break;
      case 33422:  // CFAPattern
      case 64777:  // the same of another maker
        // LibRaw 0.20 writes past its end where a pattern of 36 does not follow its size.
        if (length != 36 || self.pattern_is_6x6) break;
        self.refusal = "its CFAPattern has 36 colours, but its CFARepeatPatternDim is not 6x6";
        throw LIBRAW_EXCEPTION_IO_CORRUPT;
      case 51041:
        self.read_noise_profile(in, type, length, order);
        break;
    }
  }

  void read_pattern_size(LibRaw_abstract_datastream& in, unsigned order) {
    unsigned char bytes[4] = {};
    in.read(bytes, 1, sizeof bytes);
    const int high = order == 0x4d4d ? 0 : 1;
    const auto side = [&](int at) { return 256 * bytes[at + high] + bytes[at + 1 - high]; };
    pattern_is_6x6 = side(0) == 6 && side(2) == 6;
  }

  void read_noise_profile(LibRaw_abstract_datastream& in, int type, int length, unsigned order) {
    constexpr int of_doubles = 12, most = 2 * 4;
    if (type != of_doubles || length < 2 || length > most) return;
    auto& values = noise_profile;
    values.assign(static_cast<std::size_t>(length), 0.0);
    for (double& value : values) {
      unsigned char bytes[8];
      if (in.read(bytes, 1, 8) != 8) {
        values.clear();
        return;
      }
      if (order == 0x4d4d) std::reverse(bytes, bytes + 8);
      std::memcpy(&value, bytes, 8);
    }
  }

  /// Of green, where each colour has its own.
  std::optional<NoiseModel> noise() const {
    const auto& values = noise_profile;
    if (values.empty()) return std::nullopt;
    const std::size_t at = values.size() >= 6 ? 2 : 0;
    const NoiseModel noise{values[at], values[at + 1]};
    if (!(noise.a >= 0.0 && noise.b >= 0.0 && noise.a < 1.0 && noise.b < 1.0 && noise.a + noise.b > 0.0))
      return std::nullopt;
    return noise;
  }
};

class LibRawFile : public File {
 public:
  explicit LibRawFile(const std::string& path) {
    raw_.set_exifparser_handler(Tags::found, &tags_);
    raw_.set_dataerror_handler(nullptr, nullptr);  // which would print; the exception tells
    const int opened = raw_.open_file(path.c_str());
    if (!tags_.refusal.empty()) throw std::runtime_error(tags_.refusal);
    check(opened);
    const auto& sizes = raw_.imgdata.sizes;
    info_.make = raw_.imgdata.idata.make;
    info_.model = raw_.imgdata.idata.model;
    info_.width = sizes.width;
    info_.height = sizes.height;
    info_.cfa = pattern();
    const auto told = [](double number) { return std::isfinite(number) && number > 0.0 ? number : 0.0; };
    info_.shutter_s = told(raw_.imgdata.other.shutter);
    info_.iso = told(raw_.imgdata.other.iso_speed);
    info_.f_number = told(raw_.imgdata.other.aperture);
    info_.flip = sizes.flip & 7;
    info_.noise = tags_.noise();
    set_colors();
    const auto& black = raw_.imgdata.color.cblack;
    constexpr std::size_t most = std::size(decltype(raw_.imgdata.color.cblack){}) - 6;
    if (std::size_t{black[4]} * black[5] > most)
      throw std::runtime_error("its black level has too large a pattern");
  }

  const Info& info() const override { return info_; }

  void unpack() override {
    check(raw_.unpack());
    if (raw_.imgdata.rawdata.raw_image == nullptr)
      throw std::runtime_error("it has colours in every pixel, expected a mosaic");
    const auto& sizes = raw_.imgdata.sizes;
    const int right = sizes.left_margin + info_.width;
    const int bottom = sizes.top_margin + info_.height;
    if (right > sizes.raw_width || bottom > sizes.raw_height ||
        sizes.raw_pitch < static_cast<std::size_t>(right) * sizeof(ushort))
      throw std::runtime_error("its active area is not inside its picture");
  }

  void read(std::span<float> samples) override {
    const ushort* pixels = raw_.imgdata.rawdata.raw_image;
    const auto& sizes = raw_.imgdata.sizes;
    const std::size_t pitch = sizes.raw_pitch / sizeof(ushort);
    const double white = raw_.imgdata.rawdata.color.maximum;
    auto sample = samples.begin();
    for (int y = 0; y < info_.height; ++y) {
      const ushort* row = pixels + (y + sizes.top_margin) * pitch + sizes.left_margin;
      for (int x = 0; x < info_.width; ++x) {
        const double black = black_of(x, y);
        if (!(white > black)) throw std::runtime_error("its white level is not above its black level");
        *sample++ = static_cast<float>((row[x] - black) / (white - black));
      }
    }
    raw_.recycle();
  }

 private:
  CfaPattern pattern() {
    const auto& idata = raw_.imgdata.idata;
    if (idata.filters == 0 || idata.colors != 3)
      throw std::runtime_error("it has no mosaic of red, green and blue");
    const auto color_at = [&](int x, int y) {
      const char name = idata.cdesc[raw_.COLOR(y, x)];
      if (name != 'R' && name != 'G' && name != 'B')
        throw std::runtime_error(std::string("its mosaic has the colour ") + name + ", expected R, G and B");
      return static_cast<std::uint8_t>(name == 'R' ? 0 : name == 'G' ? 1 : 2);
    };
    if (raw_.is_fuji_rotated())
      throw std::runtime_error("its mosaic lies diagonally, expected one in rows and columns");
    CfaPattern cfa;
    cfa.period = idata.filters == 9 ? 6 : 2;
    for (int y = 0; y < cfa.period; ++y) {
      for (int x = 0; x < cfa.period; ++x) cfa.colors[y * cfa.period + x] = color_at(x, y);
    }
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 12; ++x) {
        if (color_at(x, y) != cfa.color(x, y))
          throw std::runtime_error("its mosaic repeats neither in 2x2 nor in 6x6 pixels");
      }
    }
    for (int wanted = 0; wanted < 3; ++wanted) {
      const auto end = cfa.colors.begin() + cfa.period * cfa.period;
      if (std::find(cfa.colors.begin(), end, wanted) == end)
        throw std::runtime_error("its mosaic lacks one of red, green and blue");
    }
    return cfa;
  }

  /// LibRaw's colour matrix turns colours that are balanced for daylight into Rec. 709; its inverse, with
  /// the factors of daylight taken out, is DNG's ColorMatrix.
  void set_colors() {
    const auto& color = raw_.imgdata.color;
    const bool as_shot = color.cam_mul[0] > 0 && color.cam_mul[1] > 0 && color.cam_mul[2] > 0;
    const float* factors = as_shot ? color.cam_mul : color.pre_mul;
    Matrix to_rec709{};
    for (int i = 0; i < 3; ++i) {
      // Others are no light's.
      constexpr float most = 1000.0f;
      const float factor = factors[i] / factors[1];
      if (factor > 1.0f / most && factor < most) info_.white_balance[i] = factor;
      for (int j = 0; j < 3; ++j) {
        to_rec709.m[i][j] = color.rgb_cam[i][j];
        info_.camera_to_rec709[3 * i + j] = color.rgb_cam[i][j];
      }
    }
    const Matrix from_rec709 = inverse(to_rec709);
    for (int i = 0; i < 3; ++i) {
      const double daylight =
          color.pre_mul[i] > 0 && color.pre_mul[1] > 0 ? color.pre_mul[i] / color.pre_mul[1] : 1.0;
      for (int j = 0; j < 3; ++j) {
        double sum = 0.0;
        for (int k = 0; k < 3; ++k) sum += from_rec709.m[i][k] * kRec709[k][j];
        info_.xyz_to_camera[3 * i + j] = static_cast<float>(sum / daylight);
      }
    }
    for (const auto* matrix : {&info_.camera_to_rec709, &info_.xyz_to_camera}) {
      if (!std::ranges::all_of(*matrix, [](float value) { return std::isfinite(value); }))
        throw std::runtime_error("its colour matrix has values that are not finite");
    }
  }

  double black_of(int x, int y) {
    const auto& color = raw_.imgdata.rawdata.color;
    double black = color.black + color.cblack[raw_.COLOR(y, x) & 3];
    if (color.cblack[4] > 0 && color.cblack[5] > 0)
      black += color.cblack[6 + (y % color.cblack[4]) * color.cblack[5] + x % color.cblack[5]];
    return black;
  }

  Tags tags_;
  LibRaw raw_;
  Info info_;
};

class LibRawLibrary : public Library {
 public:
  std::unique_ptr<File> open(const std::string& path) override { return std::make_unique<LibRawFile>(path); }

  void demosaic(std::span<const std::byte> dng, std::span<float> rgb) override {
    LibRaw raw;
    raw.set_dataerror_handler(nullptr, nullptr);
    auto& params = raw.imgdata.params;
    params.output_color = 0;
    params.output_bps = 16;
    params.gamm[0] = params.gamm[1] = 1.0;
    params.no_auto_bright = 1;
    params.no_auto_scale = 1;
    params.user_flip = 0;
    params.user_qual = 3;
    check(raw.open_buffer(const_cast<std::byte*>(dng.data()), dng.size()));
    check(raw.unpack());
    check(raw.dcraw_process());
    const auto& sizes = raw.imgdata.sizes;
    const std::size_t pixels = std::size_t{sizes.iwidth} * sizes.iheight;
    if (3 * pixels != rgb.size()) throw std::runtime_error("LibRaw cut it to another size");
    for (std::size_t i = 0; i < pixels; ++i) {
      for (int c = 0; c < 3; ++c) rgb[3 * i + c] = raw.imgdata.image[i][c];
    }
  }
};

}  // namespace
}  // namespace becalm::raw

extern "C" becalm::raw::Library* becalm_raw_library() {
  static becalm::raw::LibRawLibrary library;
  return &library;
}
