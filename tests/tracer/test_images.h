#pragma once

#include <OpenImageIO/typedesc.h>

#include <string>
#include <vector>

namespace becalm::tracer::test {

/// An image in the running test's folder. Rows from the top. Returns its path.
std::string write_image(const std::string& name, int width, int height, int channels,
                        const std::vector<float>& pixels, OIIO::TypeDesc samples);
/// The same with samples of 8 bits for .png and of float otherwise.
std::string write_image(const std::string& name, int width, int height, int channels,
                        const std::vector<float>& pixels);

}  // namespace becalm::tracer::test
