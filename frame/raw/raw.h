#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "frame/mosaic.h"

/// Raw files of cameras, read by LibRaw, which the first call of raw::library() loads.
namespace becalm::raw {

/// What a file tells of its mosaic. Numbers that it does not tell are 0.
struct Info {
  std::string make;
  std::string model;
  int width = 0;  ///< of the active area, as is the mosaic
  int height = 0;
  CfaPattern cfa;  ///< from the active area's first pixel on
  double shutter_s = 0.0;
  double iso = 0.0;
  double f_number = 0.0;
  int flip = 0;  ///< what turns the picture upright: 1 mirrors left-right, 2 up-down, 4 then transposes
  std::array<float, 3> white_balance{1, 1, 1};  ///< factors that make grey of white light; green has 1
  /// Row-major: white-balanced colours of the camera to linear Rec. 709.
  std::array<float, 9> camera_to_rec709{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<float, 9> xyz_to_camera{};  ///< row-major, D65, without white balance; for DNG files
  std::optional<NoiseModel> noise;       ///< DNG's NoiseProfile, of green
};

/// An open file.
class File {
 public:
  virtual ~File() = default;
  virtual const Info& info() const = 0;
  /// Decodes the samples. Before memory is taken for them, absurd sizes and truncated files are refused.
  /// Throws std::runtime_error with the reason.
  virtual void unpack() = 0;
  /// Writes the active area's samples, once they are decoded; black is subtracted and white is 1. May be
  /// called once. Throws std::runtime_error with the reason.
  virtual void read(std::span<float> samples) = 0;
};

class Library {
 public:
  virtual ~Library() = default;
  /// Reads the header. Throws std::runtime_error with the reason if the file is no raw file, or has no mosaic
  /// of red, green and blue in a 2x2 or 6x6 pattern.
  virtual std::unique_ptr<File> open(const std::string& path) = 0;
  /// Interpolates the two missing colours of every pixel: by AHD (Bayer), or Markesteijn's method in three
  /// passes (X-Trans). `dng` is a DNG file whose samples are to be taken as they are: white-balanced, of 16
  /// bits. Writes three channels in units of its samples.
  virtual void demosaic(std::span<const std::byte> dng, std::span<float> rgb) = 0;
};

/// Throws Error(resource) if the library cannot be loaded.
Library& library();

/// Opens a file. Throws Error(bad_input) naming it.
std::unique_ptr<File> open(const std::string& path);
/// Reads an open file. Throws Error(bad_input) naming it.
Mosaic read(File& file, const std::string& path);

/// Demosaics, and converts to linear Rec. 709, where white is 1, and turns the picture upright.
/// White-balanced values above white are cut to it, so that saturated pixels are white whatever the light's
/// colour. Three channels. Throws Error(resource) if LibRaw cannot be loaded or cannot demosaic.
Image develop(const Mosaic& mosaic, const Info& info);

}  // namespace becalm::raw
