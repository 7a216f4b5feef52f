// Radiance without the albedo, and back.

/// What radiance is divided by: the albedo, but for nearly black ones, whose radiance did not come from them and would be
/// blown up. Continuous, so that a texture around the limit stays even.
vec3 divisor_of(vec3 albedo) { return max(albedo, vec3(0.04)); }
