// Whether a pixel shows a surface. The including kernel defines the texel buffers `albedo_depth` and `normal`, packed
// as by filter/input/host_images.h.

/// 1: frames have a normal, which is 0 where nothing was hit.
layout(constant_id = 10) const int has_normal = 1;

/// Two hundred times the frame's typical depth.
const float kFarthestSurface = 1.99;

bool shows_surface(int index) {
  const vec3 n = texelFetch(normal, index).xyz;
  return texelFetch(albedo_depth, index).a < kFarthestSurface && (has_normal == 0 || dot(n, n) > 0.0);
}
