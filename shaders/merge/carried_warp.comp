// Reads a carried image of the history (merged with the beauty's weights); writes it at the target's pixels,
// as merge/warp_history does with the beauty. An additive AOV takes the share of the sharp filter of the
// image that it is a part of, so AOVs that add up before add up afterwards; it is not clamped, since its
// range is not that of the sum. Noisy layers (`in_range`) find a share of their own, which keeps them within
// the range of the nearest pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

layout(constant_id = 0) const int resample = 1;      // as in lib/resample.glsl
layout(constant_id = 1) const int in_range = 0;      // 1: finds the image's own share
layout(constant_id = 2) const int writes_share = 0;  // 1: writes it

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 history_color_size; };
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer history_color;
layout(set = 0, binding = 2) uniform samplerBuffer holes;  // by merge/warp_history
layout(set = 0, binding = 3) uniform samplerBuffer target_origin;
layout(set = 0, binding = 4) uniform samplerBuffer share;
layout(std430, set = 0, binding = 5) writeonly buffer WarpedBuffer { vec4 data[]; } warped;
layout(std430, set = 0, binding = 6) writeonly buffer OwnShareBuffer { float data[]; } own_share;

#include "lib/read_history.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const HistoryRead h = read_history(place_in_history(at, index), int(texelFetch(holes, index).x));
  vec4 color;
  if (in_range != 0) {
    const float sharp = share_in_range(h);
    if (writes_share != 0) own_share.data[index] = sharp;
    color = clamp(h.bilinear + sharp * (h.sharp - h.bilinear), h.lowest, h.highest);
  } else {
    color = h.bilinear + texelFetch(share, index).x * (h.sharp - h.bilinear);
  }
  warped.data[index] = h.found ? color : vec4(0.0);
}
