/// Combines two estimates. At a weight of 0 or 1 the result is selected instead of computed, since the other
/// estimate may hold anything.
vec4 combine(vec4 forward, vec4 backward, float weight_backward) {
  return weight_backward <= 0.0   ? forward
         : weight_backward >= 1.0 ? backward
                                  : forward + weight_backward * (backward - forward);
}
