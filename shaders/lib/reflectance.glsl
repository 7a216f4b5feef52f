// Radiance without the albedo, and back.

/// What radiance is divided by: the albedo, but for nearly black ones, whose radiance did not come from them and would be
/// blown up. Continuous, so that a texture around the limit stays even.
vec3 divisor_of(vec3 albedo) { return max(albedo, vec3(0.04)); }

/// What a variance is divided by where the radiance is divided by `divisor`: variances are means over channels, so it is the
/// mean of the squares, and what comes back to the same albedo is what it was.
float variance_divisor_of(vec3 divisor) { return dot(divisor, divisor) / 3.0; }
