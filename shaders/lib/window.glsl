// The 5x5 windows of smooth/mix and smooth/finish, around the pixels of a strip: they share most of their
// rows. Taps are row-major. The including kernel defines the constant `strip`.

const int kTaps = 25;

/// Of all windows of a strip. The middle of pixel 0's window is (2, 2).
const int kWindowRows = strip + 4;
const int kWindowColumns = 5;

bool is_in_window(int row, int pixel) { return row >= pixel && row < pixel + 5; }
int window_tap(int row, int column, int pixel) { return 5 * (row - pixel) + column; }
