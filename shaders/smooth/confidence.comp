// Reads the finest scale's features and the radiance without albedo, that of a merged frame and that of the
// frame itself; writes both with each pixel's confidence in the alpha channel, and the pixel's affinities.
// The confidence multiplies the pixel's weight in every window that contains it, which keeps outliers out. It
// is nearly 0 for a pixel that is not finite.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "lib/network.glsl"

layout(constant_id = 0) const int planes = 4;  // of four features each
layout(constant_id = 1) const int framed = 0;  // as lib/head.glsl has it

layout(local_size_x = 128, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer features;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(set = 0, binding = 2) uniform samplerBuffer irradiance;
layout(set = 0, binding = 3) uniform samplerBuffer own_irradiance;
layout(std430, set = 0, binding = 4) writeonly buffer ConfidenceBuffer { vec4 data[]; } irradiance_confidence;
layout(std430, set = 0, binding = 5) writeonly buffer OwnBuffer { vec4 data[]; } own_irradiance_confidence;
layout(std430, set = 0, binding = 6) writeonly buffer AffinitiesBuffer { vec4 data[]; } affinities;

const int kMostOutputs = 6;  // the confidence, the affinities, the confidence in the frame's own radiance
const int strip = 1;
#include "lib/head.glsl"

void main() {
  load_head(kMostOutputs);
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  const bool inside = at.x < size.x && at.y < size.y;
  const int index = inside ? at.y * size.x + at.x : 0;
  apply_head(kMostOutputs, inside ? at : ivec2(0), size);
  const vec4 merged = texelFetch(irradiance, index);
  const vec4 own = texelFetch(own_irradiance, index);
  if (!inside) return;
  const float of_merged = merged.a > 0.0 ? confidence(head[0]) : kConfidenceOfHole;
  const float of_own = own.a > 0.0 ? confidence(head[5]) : kConfidenceOfHole;
  irradiance_confidence.data[index] = vec4(merged.rgb, of_merged);
  own_irradiance_confidence.data[index] = vec4(own.rgb, of_own);
  affinities.data[index] = vec4(head[1], head[2], head[3], head[4]);
}
