#pragma once

#include <Imath/ImathBox.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frame/frame.h"
#include "frame/io/layers.h"

namespace becalm::io {

/// Wider or higher images than this are refused before anything is allocated for them.
inline constexpr int kMaxImageSide = 65536;

/// What is needed to write again, bit for bit, what was not denoised. Opaque outside frame/io/.
class ExrContents;

/// What was read of one view: all of a usual file, an eye of a stereo file.
struct LoadedView : ViewLayers {
  Frame frame;
  /// By how much values near 0 may have been rounded, by index of kAovTable: half a step of half in the AOV's
  /// unit; 0 where the file has floats.
  std::array<float, kAovCount> rounding{};
  Imath::Box2i window;  ///< that the frame covers, in the file's coordinates
  /// The display window's middle, from the middle of `window`, in pixels.
  Imath::V2d middle_px{0.0, 0.0};
  /// Of light groups that are products: the surface's colour, which the frame's radiance contains.
  std::map<std::string, Image> colours;
};

/// The default view of a file, or its only one, and what the file holds besides.
struct LoadedFrame : LoadedView {
  std::vector<LoadedView> other_views;
  /// The right eye's file, if each eye has its own and this is the left one's: for who reads both.
  std::shared_ptr<LoadedFrame> other_eye;
  std::shared_ptr<const ExrContents> contents;
};

/// Text attributes written as `becalm:*`, such as {"becalm:preset", "final"}.
using Attributes = std::vector<std::pair<std::string, std::string>>;

enum class PixelType { half, float32 };

/// Whether read_exr reads ViewLayers::lights into the frame's light groups.
enum class LightGroups { leave, read };

/// What read_exr would find of one view.
struct ExrView : ViewLayers {
  Imath::Box2i data_window;  ///< of the beauty's part
  Imath::Box2i display_window;
  std::vector<std::string> part_names;  ///< of every part; empty ones for a file of one part
  bool is_checkerboard = false;         ///< the file tells which pixels of a checkerboard it holds
};

/// Whether read_exr keeps the channels that write_denoised_exr passes on, so that they are decompressed once.
/// Kept are at most 256 MiB of a file, or none.
enum class KeepPassedOn { no, yes };

/// Whether read_exr_header also looks for every chunk of pixels, which reads some bytes of each.
enum class CheckChunks { no, yes };

/// What read_exr would find, the default view first. Reads no pixels; throws as that does.
std::vector<ExrView> read_exr_header(const std::string& path, const LayerOptions& options,
                                     CheckChunks check_chunks);

/// Throws Error(bad_input) naming the file if one of the AOVs, or of the lights if they are read, has fewer
/// samples than pixels.
void require_all_samples(const std::string& path, const ViewLayers& view, AovSet aovs, LightGroups lights);

/// Whether the file is an EXR with all of its chunks. Reads no pixels. Throws Error where the system does not
/// let it be read: that says nothing of the file.
bool has_all_chunks(const std::string& path);

/// Reads one EXR file: of each view with a beauty the AOVs of `wanted` that it holds (the beauty always), and
/// everything else as contents. Each view's Frame covers `window`, or by default the data window of its
/// beauty's part; outside its own part's window an AOV has the value for pixels that hit nothing, and the
/// beauty is 0, or NaN where it is cut off in the middle of what is opaque (Frame::cut). Throws
/// Error(bad_input) naming the file for: no such file, not an EXR, truncated or corrupt pixels, no colour,
/// subsampled layers, a deep file, more than 65536 pixels a side, no pixel within `window`.
LoadedFrame read_exr(const std::string& path, int frame_number, AovSet wanted,
                     const LayerOptions& options = {}, LightGroups light_groups = LightGroups::leave,
                     const std::optional<Imath::Box2i>& window = std::nullopt,
                     KeepPassedOn keep = KeepPassedOn::no);

/// Threads with which OpenEXR compresses and decompresses, in the whole process; as many as processors unless
/// set.
void set_exr_threads(int count);

/// What `becalm info` tells of a file. Names are printable, whatever the file holds.
struct ExrDescription {
  struct Channel {
    std::string name;
    std::string type;  ///< uint, half or float
    std::string use;   ///< what it was taken for, such as `albedo.R`, or `passed on`
  };
  struct Part {
    std::string name;  ///< empty where it has none
    std::string storage;
    std::string compression;
    Imath::Box2i data_window;
    Imath::Box2i display_window;
    std::vector<Channel> channels;
  };
  std::vector<Part> parts;
  std::vector<std::string> other_beauties;  ///< of view layers that stay noisy
  bool is_checkerboard = false;             ///< the file tells which pixels of a checkerboard it holds
  std::string problem;  ///< why it could not be denoised, such as that it has no colour; or empty

  /// One line for each part, for each channel, for each other beauty, and for a checkerboard.
  std::vector<std::string> lines() const;
};

/// Reads no pixels. Throws as read_exr does, but describes a file without colour and deep ones, and those
/// whose beauty, lights or `taken` AOVs are subsampled.
ExrDescription describe_exr(const std::string& path, const LayerOptions& options = {}, AovSet taken = {});

/// The text attributes of the first part. Throws as read_exr does.
std::map<std::string, std::string> read_attributes(const std::string& path);
/// The value of one of them, or empty.
std::string read_attribute(const std::string& path, const std::string& name);

struct WriteReport {
  std::size_t half_overflows = 0;  ///< finite values beyond half's range, written as its largest value
  /// The beauty's part was compressed by ZIP instead of the lossy method of its source, or that was asked
  /// for, which would have altered channels that are passed on.
  bool lossless_instead = false;
  bool full_size_only = false;       ///< the source's part has smaller levels, which were left out
  bool diagnostics_replace = false;  ///< diagnostics took the places of channels that becalm had not made
};

/// Writes the frame's jitter and stereo camera as text attributes, and every AOV of the frame as a layer of a
/// single-part scanline file with ZIP compression, light groups as `light.NAME`: radiance, albedo and normal
/// as `color_type`; variance (whose squares leave half's range long before the radiance does), depth, motion,
/// numbers and diagnostics as float. Written beside its place and renamed, so that a killed run leaves whole
/// files only; the parent folder is made. Throws Error(resource) naming the path.
WriteReport write_exr(const std::string& path, const Frame& frame, const Attributes& attributes,
                      PixelType color_type = PixelType::half);

/// A frame as one view of a file; the name is empty where there is but one.
struct WrittenView {
  std::string name;
  const Frame* frame;
};

/// The same of one or more views, each a part of its own that bears the view's name.
WriteReport write_exr(const std::string& path, const std::vector<WrittenView>& views,
                      const Attributes& attributes, PixelType color_type = PixelType::half);

/// Writes an image of one channel as the float channel Y. Atomic and failing as write_exr.
void write_plane_exr(const std::string& path, const Image& plane, const Attributes& attributes);

/// Writes a frame, which has a beauty, small: its AOVs as half with ZIP compression, no alpha where it is 1
/// everywhere, and the variance by its root, to 12 % (`noiselevel`, which read_exr squares). Colours are
/// float where half would change one of them by more than 2^-11 of it and a sixteenth of its deviation
/// (without variance: 2^-11 of the mean colour), and so are deviations; other AOVs where they exceed half's
/// range. Light groups, jitter, stereo camera and checkerboard are left out. `first`: where its first pixel
/// lies. Atomic and failing as write_exr.
void write_compact_exr(const std::string& path, const Frame& frame, const Attributes& attributes,
                       const Imath::V2i& first = Imath::V2i(0));

/// Which channels are written: by default all.
struct ChannelSelection {
  /// Channels, layers (`diffuse` for `diffuse.R`), parts, PART/LAYER, or `beauty`; all where there are none.
  /// A deep part is selected where all of its channels are.
  std::vector<std::string> names = {};
  bool denoised = false;  ///< those that were denoised, and diagnostics, whatever their names

  bool selects_all() const { return names.empty() && !denoised; }
};

/// Throws Error(usage) naming `option` if one of the names is of no channel of the file.
void check_selection(const std::string& path, const LayerOptions& options, const ChannelSelection& selection,
                     std::string_view option);

/// How the parts of the denoised channels are written; by default as the source is.
struct DenoisedFormat {
  /// Of the frame's sides to the source's: the display window and the windows of all parts are scaled.
  Scale scale = {};
  std::optional<PixelType> type;             ///< of the denoised channels
  std::optional<std::string> compression{};  ///< one of compression_names()
  /// Parts without a channel that is selected are left out.
  ChannelSelection channels = {};
  /// The frame's alpha is the source's: it keeps its type, and no compression may alter it.
  bool keeps_alpha = false;
};

/// Throws Error(bad_input) if the file has a deep part that is selected, which write_denoised_exr cannot
/// scale.
void check_scaling(const std::string& path, const ChannelSelection& selection);

/// none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa and dwab.
std::span<const std::string_view> compression_names();

/// Writes `source` again with the channels of the beauty, and of direct, indirect and light groups as far as
/// the frame has them, replaced by the frame's, in the same parts, types, compression, windows and
/// attributes, every other channel bit for bit; the frame is cut to the file's window; diagnostics of the
/// frame are added as layers to the beauty's part, and of its mipmap levels only the full size is written.
/// If the frame has another scale, or its source is a checkerboard, each pixel of another channel is the
/// nearest sample's, bit for bit, but for motion, which is multiplied by the scale; deep parts throw
/// Error(bad_input). `other_views` are the frames of the source's other views, in their
/// order. What was not kept of the source's file is read again: throws Error(bad_input) naming it if it has
/// changed since, or if its window is not inside the frame's. Atomic as write_exr is.
WriteReport write_denoised_exr(const std::string& path, const Frame& frame,
                               const std::vector<Frame>& other_views, const LoadedFrame& source,
                               const Attributes& attributes, const DenoisedFormat& format = {});

}  // namespace becalm::io
