#pragma once

#include <Imath/ImathVec.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfPixelType.h>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "frame/frame.h"
#include "frame/io/exr.h"
#include "frame/io/stripe.h"

namespace becalm::io {

/// One channel of the frame on its way into a file, under the file's name for it.
struct FrameChannel {
  const Image* image;
  int channel;
  Imath::V2i origin = Imath::V2i(0);  ///< of the image in the file
  bool passed_on = false;             ///< the values are the source's, and must not be altered
};

using FrameChannels = std::map<std::string, FrameChannel>;

/// Whether a denoised frame's image takes the place of its source's.
inline bool is_denoised(Aov aov) {
  return aov == Aov::beauty || aov == Aov::direct || aov == Aov::indirect;
}

/// Adds the AOV as a layer under the table's name (bare for the beauty), with the view's if there is one.
void add_layer(const Frame& frame, Aov aov, const std::string& view, Imf::PixelType type,
               const Imath::V2i& origin, Imf::Header& header, FrameChannels& channels);

void insert_attributes(Imf::Header& header, const Attributes& attributes);

/// Runs `work` on a file that appears at `path` when it returns, turning what OpenEXR throws into
/// Error(resource).
void writing(const std::string& path, const std::vector<Imf::Header>& headers,
             const std::function<void(Imf::MultiPartOutputFile&)>& work);

/// Fills the planes of a stripe for which `wanted` is true with its lines.
using ReadLines =
    std::function<void(Stripe& stripe, const std::function<bool(const Stripe::Plane&)>& wanted)>;

/// Lines of a part of a file.
ReadLines lines_of(Imf::InputPart& part);

/// Writes the pixels of one part: the channels that `from_frame` names, and all others as `read` gives them,
/// which may be empty if there are none.
void write_part(Imf::MultiPartOutputFile& file, int part, const FrameChannels& from_frame,
                const ReadLines& read, WriteReport& report);

/// The same for a part of another size than its source's: each pixel of a channel that is not the frame's is
/// that of `nearest`, whose scale motion channels are multiplied by.
void write_scaled_part(Imf::MultiPartOutputFile& file, int part, const FrameChannels& from_frame,
                       Imf::InputPart& source, const NearestSample& nearest,
                       const std::set<std::string>& motion_channels, WriteReport& report);

/// Copies a part's chunks as they are, still compressed.
void copy_part(Imf::MultiPartInputFile& from, int part, Imf::MultiPartOutputFile& to, int to_part);

}  // namespace becalm::io
