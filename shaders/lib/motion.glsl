#include "lib/language.glsl"

/// Motion is known if both components are below 1e6 px; pixels without motion hold 1e6 or more.
bool is_known_motion(float x, float y) { return abs(x) < 1e6f && abs(y) < 1e6f; }
