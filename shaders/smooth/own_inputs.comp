// Reads the grey value and the features of a frame, or for a merged frame those of the frame itself; writes the
// network's last input channels: albedo, normal, depth, grey value.
#version 460

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 own_albedo_depth_size; };
layout(set = 0, binding = 0) uniform samplerBuffer own_grey;
layout(set = 0, binding = 1) uniform samplerBuffer own_albedo_depth;
layout(set = 0, binding = 2) uniform samplerBuffer own_normal;
layout(std430, set = 0, binding = 3) writeonly buffer SurfaceBuffer { vec4 data[]; } surface_inputs;
layout(std430, set = 0, binding = 4) writeonly buffer GreyBuffer { vec4 data[]; } grey_inputs;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const int from =
      min(at.y, own_albedo_depth_size.y - 1) * own_albedo_depth_size.x + min(at.x, own_albedo_depth_size.x - 1);
  const vec4 features = texelFetch(own_albedo_depth, from);
  const vec3 n = texelFetch(own_normal, from).xyz;
  surface_inputs.data[index] = vec4(features.rgb, n.x);
  grey_inputs.data[index] = vec4(n.yz, features.a, texelFetch(own_grey, index).x);
}
