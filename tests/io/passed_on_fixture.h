#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "frame/io/exr.h"
#include "tests/io/exr_files.h"
#include "tests/io/temporary_folder.h"

namespace becalm::io {

/// A source file, and the result that write_denoised_exr writes for it.
class PassedOn : public ::testing::Test {
 protected:
  /// Reads `source_`, doubles the beauty, adds the diagnostics that are wanted, and writes `result_`.
  WriteReport denoise(AovSet diagnostics = {}, const LayerOverrides& overrides = {},
                      const DenoisedFormat& format = {});

  /// Expects every channel of the part to have its bits, except for the named ones, which must differ.
  void expect_same_but_for(const std::vector<std::string>& replaced, int part = 0) const;

  /// Expects the result's header to equal the source's, except for becalm's attributes, the channels and the
  /// named attributes.
  void expect_same_header(int part = 0, const std::vector<std::string>& but_for = {}) const;

  TemporaryFolder folder_;
  const std::string source_ = folder_.path("source.exr");
  const std::string result_ = folder_.path("out/result.exr");
  LayerMap layers_;
};

/// Channels of every type.
inline const std::vector<TestChannel> kMixed = {{"R"},
                                                {"G", Imf::FLOAT},
                                                {"B"},
                                                {"A", Imf::FLOAT},
                                                {"raw.half"},
                                                {"raw.float", Imf::FLOAT},
                                                {"raw.id", Imf::UINT},
                                                {"depth.Z", Imf::FLOAT}};
inline const std::vector<std::string> kBeauty = {"R", "G", "B", "A"};

/// Adds attributes that each part of a file may have.
void add_attributes_of_a_part(Imf::Header& header);
/// Adds those, and two that all parts of a file share.
void add_attributes(Imf::Header& header);

}  // namespace becalm::io
