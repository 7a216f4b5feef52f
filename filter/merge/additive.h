#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "filter/estimate.h"
#include "filter/gpu/chain.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/tiles.h"
#include "frame/frame.h"

namespace becalm::filter {

/// Additive AOVs: the light groups, and direct and indirect light, each of which add up to the beauty. They
/// go through the filter as RGBA images (A is 0) in the order of additive_images, with the beauty's weights.
AovSet additive_aovs();

/// The additive AOVs of a frame: those of additive_aovs() that are in `used`, then the light groups
/// by their names.
std::vector<Image*> additive_images(Frame& frame, const AovSet& used);
std::vector<const Image*> additive_images(const Frame& frame, const AovSet& used);

/// The additive AOVs of a new frame, ready for the chains: where the beauty is not finite the mean of finite
/// neighbours, as pack_color makes it; values that are not finite where the beauty is are 0 and counted in
/// the report. Throws Error(bad_input) if the frame has not as many as the task says.
std::vector<Image> pack_additive(const Frame& frame, const FilterTask& task,
                                 std::span<const std::uint8_t> finite, FrameReport& report);

/// Gives `result`, a denoised frame, the additive AOVs of `frame` as `denoised` has them; as they came in the
/// pixels that `as_they_came` marks.
void unpack_additive(const NewFrame& frame, const FilterTask& task, const std::vector<Image>& denoised,
                     std::span<const std::uint8_t> as_they_came, Frame& result);

/// `count` inputs of a chain (f32x4), one for each additive AOV or image that is carried.
std::vector<gpu::ImageId> additive_inputs(gpu::Chain& chain, std::size_t count, gpu::Extent extent,
                                          const std::string& name);

/// Fills such inputs with a rectangle.
void upload_additive(gpu::Chain& chain, const std::vector<gpu::ImageId>& inputs,
                     const std::vector<Image>& images, const Rect& rect);

/// What a chain made of additive AOVs, if anything.
std::vector<std::span<const float>> download_additive(const gpu::Chain& chain,
                                                      const std::vector<gpu::ImageId>& images);

}  // namespace becalm::filter
