#include "lib/language.glsl"

/// Pixels without known motion hold more than that in both components.
bool is_known_motion(float x, float y) { return abs(x) < 1e6f && abs(y) < 1e6f; }
