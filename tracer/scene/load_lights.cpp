#include <OpenImageIO/imageio.h>

#include "tracer/scene/load_sections.h"

namespace becalm::tracer {

namespace {

/// The image as floats. Throws an error at the JSON value that names it.
Image read_image(const JsonValue& json, const std::string& path) {
  expect_file(json, path);
  const auto file = OIIO::ImageInput::open(path);
  if (!file) json.fail(fmt::format("cannot read '{}': {}", path, OIIO::geterror()));
  const OIIO::ImageSpec& spec = file->spec();
  Image image(spec.width, spec.height, spec.nchannels);
  if (!file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, image.data().data())) {
    json.fail(fmt::format("cannot read '{}': {}", path, file->geterror()));
  }
  return image;
}

}  // namespace

void read_environment(const JsonValue& json, SceneDescription& scene) {
  if (json.has("image")) {
    json.allow_keys({"image", "scale", "rotate_y_deg"});
    const JsonValue image = json.at("image");
    const double scale = json.has("scale") ? json.at("scale").number(0.0, kLargestNumber) : 1.0;
    const double rotation = json.has("rotate_y_deg") ? json.at("rotate_y_deg").number() : 0.0;
    scene.environment = Environment::image(read_image(image, beside(scene.file, image.string())),
                                           static_cast<float>(scale), static_cast<float>(rotation));
    scene.environment_is_image = true;
  } else {
    json.allow_keys({"radiance"});
    scene.environment = Environment::constant(read_color(json.at("radiance"), kLargestNumber));
  }
}

}  // namespace becalm::tracer
