// How much a pixel of a window counts for another one by what it shows: light that is alike but for its noise does not tell
// surfaces apart, and one plane cannot fit two of them. Differences of normal, albedo and depth are measured by how these
// change at the pixel anyway (after Rousselle et al. 2013, "Robust denoising using feature and color information"), so that
// a curved surface stays one. Differs from the paper: of both sides the smaller step counts, so that a silhouette is no
// slope, and the differences of all features add up. Albedos of a pattern are surfaces of their own. Not pure functions: the
// including kernel has the parameters, and texel buffers albedo_depth and normal.

/// Of squared differences of normal, albedo and depth, the last as it is packed, in [0,2].
const vec3 kSurfaceFalloff = vec3(1.0, 2.0, 1000.0);
/// Squared steps from a pixel to the next that two pixels of one surface may be apart.
const float kSlopeAllowance = 10.0;
/// Taken off every weight, so that none is too small to matter. Without a step: kernels that round differently agree.
const float kLeastSurfaceWeight = 1.0 / 512.0;

vec3 squared_differences(vec4 a, vec3 n) { return vec3(dot(n, n), dot(a.rgb, a.rgb), a.a * a.a); }

/// Squared difference between a pixel and the one at a shift from it, or at the opposite one beyond the frame's border.
vec3 squared_step(ivec2 at, ivec2 shift) {
  const int here = at.y * p.width + at.x;
  const ivec2 size = ivec2(p.width, p.height);
  ivec2 q = at + shift;
  if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, size))) q = clamp(at - shift, ivec2(0), size - 1);
  const int there = q.y * p.width + q.x;
  return squared_differences(texelFetch(albedo_depth, there) - texelFetch(albedo_depth, here),
                             texelFetch(normal, there).xyz - texelFetch(normal, here).xyz);
}

/// What squared differences to the pixel are multiplied by: less where its surface changes.
vec3 surface_falloff(ivec2 at) {
  const vec3 along_x = min(squared_step(at, ivec2(-1, 0)), squared_step(at, ivec2(1, 0)));
  const vec3 along_y = min(squared_step(at, ivec2(0, -1)), squared_step(at, ivec2(0, 1)));
  const vec3 falloff = p.surfaces * kSurfaceFalloff;
  return falloff / (1.0 + kSlopeAllowance * falloff * max(along_x, along_y));
}

/// Of a pixel that differs by `a` in albedo and depth and by `n` in normal.
float surface_weight(vec4 a, vec3 n, vec3 falloff) {
  const float weight = exp(-dot(falloff, squared_differences(a, n)));
  return max(weight - kLeastSurfaceWeight, 0.0) / (1.0 - kLeastSurfaceWeight);
}
