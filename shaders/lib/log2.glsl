#include "lib/language.glsl"

/// log2(x) for finite x >= 1, within 2.2e-6; exactly 0 at 1. A least-squares polynomial on the mantissa,
/// reweighted towards the smallest maximum error: with the software device's own log2 the whole search takes
/// a fifth longer.
float log2_of_product(float x) {
  int bits = floatBitsToInt(x);
  float exponent = float((bits >> 23) - 127);
  float f = intBitsToFloat((bits & 0x7fffff) | 0x3f800000) - 1.0f;
  return exponent + f * (1.4425532f + f * (-0.7182815f + f * (0.45826885f + f * (-0.2795342f + f * (0.1234479f - f * 0.02645623f)))));
}
