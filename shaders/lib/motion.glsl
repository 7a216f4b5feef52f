#include "lib/language.glsl"

/// Pixels without known motion hold this in both components.
const float kNoMotion = 1e30f;

bool is_known_motion(float x, float y) { return abs(x) < 1e6f && abs(y) < 1e6f; }
