#pragma once

#include <string>
#include <vector>

namespace becalm::tracer::test {

/// An image in the running test's folder, 8 bits for .png and float otherwise. Rows from the top. Returns its
/// path.
std::string write_image(const std::string& name, int width, int height, int channels,
                        const std::vector<float>& pixels);

}  // namespace becalm::tracer::test
