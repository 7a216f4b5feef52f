// The 5x5 window of smooth/mix and smooth/finish.

const int kTaps = 25;

/// Taps are row-major.
ivec2 window_offset(int tap) { return ivec2(tap % 5 - 2, tap / 5 - 2); }
