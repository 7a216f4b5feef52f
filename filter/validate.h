#pragma once

#include <optional>

#include "filter/gpu/chain.h"
#include "filter/merge.h"
#include "filter/settings.h"
#include "frame/aov.h"

namespace becalm::filter {

/// Flags of the rules in `validate` that frames with these AOVs allow.
unsigned applicable_rules(const Settings& settings, const AovSet& available);

/// How far from a pixel validation and rectification read the new frame.
int validate_margin_px(const Settings& settings);

/// How far the history may be trusted where the new frame's pixels are (f32x2): trust in [0,1] and, in the
/// values of shaders/lib/rejection.glsl, the rule that doubts most. `rules` are flags of Validate, at least
/// one; the surface is read for those of kValidateBySurface, the alignment's consistency for validate_flow.
gpu::ImageId add_validate_pass(gpu::Chain& chain, const Settings& settings, gpu::Extent full, unsigned rules,
                               const FramePair& surface, const Alignment& alignment,
                               const SourceWindow& window);

/// The warped history brought into a box of the new frame's colours, for a history_clip that is not `none`.
WarpedHistory add_rectify_pass(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                               gpu::ImageId color, gpu::ImageId variance, const WarpedHistory& warped);

}  // namespace becalm::filter
