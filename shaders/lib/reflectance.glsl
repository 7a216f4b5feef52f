// Division of radiance by albedo.

/// Divisor of the radiance: the albedo, but at least 0.04. Radiance of nearly black surfaces does not come
/// from their albedo, and the division would amplify it. The limit is continuous, so a texture around it
/// stays even.
vec3 divisor_of(vec3 albedo) { return max(albedo, vec3(0.04)); }
