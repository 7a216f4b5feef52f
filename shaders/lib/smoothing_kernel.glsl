// The sum over a window that smooth/regress amounts to: of w c (k.x - dot(k.yzw, n) - dot(of_albedo_depth, a)) for the
// weights w of patches and surfaces, the radiance c without albedo, and the differences of normal and of albedo and depth
// to the pixel, n and a. Not a pure function: the including kernel has the parameters and the texel buffers color, variance,
// albedo_depth, normal and weights.
#include "lib/patch_weights.glsl"
#include "lib/reflectance.glsl"
#include "lib/surface_weight.glsl"

vec3 apply_smoothing_kernel(ivec2 at, int radius, vec4 k, vec4 of_albedo_depth) {
  const int shifts = (2 * radius + 1) * (2 * radius + 1);
  const int planes = (shifts + kShiftsPerPlane - 1) / kShiftsPerPlane;
  const vec4 albedo_depth_here = texelFetch(albedo_depth, at.y * p.width + at.x);
  const vec3 normal_here = texelFetch(normal, at.y * p.width + at.x).xyz;
  const vec3 falloff = surface_falloff(at);
  vec3 sum = vec3(0.0);
  for (int plane = 0; plane < planes; ++plane) {
    const uint packed = texelFetch(weights, (plane * p.height + at.y) * p.width + at.x).x;
    [[unroll]] for (int i = 0; i < kShiftsPerPlane; ++i) {
      const ivec2 q = clamp(at + window_shift(plane * kShiftsPerPlane + i, radius), ivec2(0), ivec2(p.width, p.height) - 1);
      const int tap = q.y * p.width + q.x;
      const vec4 albedo_depth_there = texelFetch(albedo_depth, tap);
      const vec4 a = albedo_depth_there - albedo_depth_here;
      const vec3 n = texelFetch(normal, tap).xyz - normal_here;
      const float w = float((packed >> (8 * i)) & 255u) / 255.0 * texelFetch(variance, tap).y * surface_weight(a, n, falloff);
      const float share = k.x - dot(k.yzw, n) - dot(of_albedo_depth, a);
      sum += w * share * (texelFetch(color, tap).rgb / divisor_of(albedo_depth_there.rgb));
    }
  }
  return sum * divisor_of(albedo_depth_here.rgb);
}
