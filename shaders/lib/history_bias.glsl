// How far the history is off, beyond what noise explains. Not pure functions: the including kernel declares the texel
// buffers color, variance, warped_color and warped_stats, and the constants `sparse` and `bias_radius`.
#include "lib/squared.glsl"

/// Share of the expected noise that is subtracted from a squared difference before the rest counts as bias:
/// smaller values follow motion sooner, larger ones average longer. Chosen on the shots of
/// scripts/benches/antialias: from 0.4 to 1, still shots gain 3 % and moving ones lose as much.
const float kExplained = 0.5;
/// Variances of the difference beyond which a pixel's own difference is bias, whatever its neighbours say.
const float kCertain = 9.0;
/// Fewest frames that a history may be worth.
const float kFewest = sparse != 0 ? 1e-3 : 1.0;

/// Side of the square of pixels that bias is measured over.
const int kSide = 2 * bias_radius + 1;

/// x over a pixel's confidence. In whole frames, where that is 1, x itself: some devices round even x / 1.
float divided(float x, float confidence) { return sparse != 0 ? x / confidence : x; }

/// The variance of a whole frame's pixel and the squared bias of the history, over the pixels around, which count by
/// their confidence: the bias is what noise does not explain of their mean squared difference, or of the pixel's own.
vec2 variance_and_bias(ivec2 at, int index, float n) {
  float squares = 0.0;
  float noise = 0.0;
  float weight = 0.0;
  float count = 0.0;
  [[unroll]] for (int k = 0; k < kSide * kSide; ++k) {
    const ivec2 q = at + ivec2(k % kSide, k / kSide) - kSide / 2;
    const bool inside = q.x >= 0 && q.y >= 0 && q.x < size.x && q.y < size.y;
    const int tap = inside ? q.y * size.x + q.x : index;
    const vec2 new_stats = texelFetch(variance, tap).xy;
    const float w = inside && new_stats.y > 0.0 && texelFetch(warped_stats, tap).y > 0.0 ? new_stats.y : 0.0;
    squares += w * squared(texelFetch(color, tap).rgb - texelFetch(warped_color, tap).rgb);
    noise += w * w * new_stats.x;
    weight += w;
    count += w > 0.0 ? 1.0 : 0.0;
  }
  weight = max(weight, kFewest);
  const float of_frame = noise / weight;
  const float of_history = 1.0 / max(n, kFewest);
  const float expected = kExplained * of_frame * ((sparse != 0 ? count / weight : 1.0) + of_history);
  const float expected_own =
      sparse != 0 ? kExplained * of_frame * (1.0 / texelFetch(variance, index).y + of_history) : expected;
  const float own = squared(texelFetch(color, index).rgb - texelFetch(warped_color, index).rgb);
  return vec2(of_frame, max(max(squares / weight - expected, own - kCertain * expected_own), 0.0));
}
