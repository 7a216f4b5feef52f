// Bilinear read of an offset field at another resolution. The including kernel declares a buffer `offset_coarse`.

/// Offset at the centre of pixel `at` of an image whose size is `scale` times that of the field.
vec2 read_offset(ivec2 at, ivec2 field_size, float scale) {
  const vec2 position = (vec2(at) + 0.5) / scale - 0.5;
  const vec2 base = floor(position);
  const vec2 t = position - base;
  const ivec2 lo = clamp(ivec2(base), ivec2(0), field_size - 1);
  const ivec2 hi = clamp(ivec2(base) + 1, ivec2(0), field_size - 1);
  const vec2 top = mix(offset_coarse.data[lo.y * field_size.x + lo.x], offset_coarse.data[lo.y * field_size.x + hi.x], t.x);
  const vec2 bottom = mix(offset_coarse.data[hi.y * field_size.x + lo.x], offset_coarse.data[hi.y * field_size.x + hi.x], t.x);
  return scale * mix(top, bottom, t.y);
}
