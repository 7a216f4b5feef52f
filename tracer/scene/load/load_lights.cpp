#include <span>
#include <stdexcept>

#include "frame/pictures/pictures.h"
#include "tracer/scene/load/load_sections.h"

namespace becalm::tracer {

namespace {

/// Of the sun as the earth sees it, on average over the year.
constexpr double kSunDiameterDeg = 0.533;

/// Integers are codes of sRGB, as in images of materials; alpha is none.
void make_linear(const pictures::Header& header, Image& image) {
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    const std::span<float> texel = image.data().subspan(i * header.channels, header.channels);
    const float alpha = header.alpha_channel < 0 ? 1.0f : texel[header.alpha_channel];
    for (int c = 0; c < header.channels; ++c) {
      if (c == header.alpha_channel) continue;
      texel[c] = alpha > 0.0f ? alpha * pictures::srgb_to_linear(texel[c] / alpha) : 0.0f;
    }
  }
}

/// The image as linear floats, multiplied by its alpha. Throws an error at the JSON value that names it.
Image read_image(const JsonValue& json, const std::string& path) {
  expect_file(json, path);
  pictures::Library& library = pictures::library();
  try {
    const std::unique_ptr<pictures::Picture> file = library.open(path, pictures::Alpha::multiplied);
    const pictures::Header& header = file->header();
    Image image(header.width, header.height, header.channels);
    file->read(image.data());
    if (!header.float_samples) make_linear(header, image);
    return image;
  } catch (const std::runtime_error& error) {
    json.fail(fmt::format("cannot read '{}': {}", path, error.what()));
  }
}

Curve<3> read_vector_curve(const JsonValue& json, double largest) {
  return read_curve<3>(json, [&](const JsonValue& value) { return value.numbers<3>(-largest, largest); });
}

Curve<3> read_position_curve(const JsonValue& json) {
  return read_vector_curve(json, kLargestCoordinate);
}

Curve<3> read_light_curve(const JsonValue& json) {
  return read_triple_curve(json, 0.0, kLargestNumber);
}

/// A direction over time. Throws where it is 0, or turns to its opposite and would pass through 0.
Curve<3> read_direction_curve(const JsonValue& json) {
  Curve<3> curve = read_vector_curve(json, kLargestNumber);
  const auto unit = [](const Curve<3>::Key& key) {
    return V3d(key.value[0], key.value[1], key.value[2]).normalized();
  };
  for (std::size_t i = 0; i < curve.keys().size(); ++i) {
    const V3d direction = unit(curve.keys()[i]);
    if (direction == V3d(0.0)) json.fail("a direction must not be 0");
    if (i > 0 && direction.dot(unit(curve.keys()[i - 1])) < -1.0 + 1e-12) {
      json.fail("a direction must not turn to its opposite between keys: it would pass through 0");
    }
  }
  return curve;
}

/// Calls check(frame) for each frame at which one of the curves has a key.
template <std::size_t N, std::size_t M, class Check>
void for_each_key(const Curve<N>& a, const Curve<M>& b, const Check& check) {
  for (const auto& key : a.keys()) check(key.frame);
  for (const auto& key : b.keys()) check(key.frame);
}

PointDescription read_point(const JsonValue& json, SceneDescription& scene) {
  json.allow_keys({"type", "position", "intensity", "group"});
  return {read_position_curve(json.at("position")), read_light_curve(json.at("intensity")),
          read_light_group(json, scene.light_groups)};
}

SpotDescription read_spot(const JsonValue& json, SceneDescription& scene) {
  json.allow_keys(
      {"type", "position", "target", "direction", "intensity", "inner_deg", "outer_deg", "group"});
  if (json.has("target") == json.has("direction")) json.fail("expected either 'target' or 'direction'");
  const bool aim_is_target = json.has("target");
  const Curve<1> outer_deg = read_number_curve(json.at("outer_deg"), 0.0, 180.0);
  SpotDescription spot{
      read_position_curve(json.at("position")),
      aim_is_target ? read_position_curve(json.at("target")) : read_direction_curve(json.at("direction")),
      aim_is_target,
      read_light_curve(json.at("intensity")),
      json.has("inner_deg") ? read_number_curve(json.at("inner_deg"), 0.0, 180.0) : outer_deg,
      outer_deg,
      read_light_group(json, scene.light_groups)};
  for_each_key(spot.inner_deg, spot.outer_deg, [&](double frame) {
    const double inner = spot.inner_deg.at(frame)[0], outer = spot.outer_deg.at(frame)[0];
    if (inner > outer) {
      json.at("inner_deg").fail(fmt::format("expected at most outer_deg, {}, found {}", outer, inner));
    }
  });
  if (aim_is_target) {
    for_each_key(spot.position, spot.aim, [&](double frame) {
      if (spot.position.at(frame) == spot.aim.at(frame)) {
        json.at("target").fail("expected another point than the position");
      }
    });
  }
  return spot;
}

SunDescription read_sun(const JsonValue& json, SceneDescription& scene) {
  json.allow_keys(
      {"type", "direction", "azimuth_deg", "elevation_deg", "diameter_deg", "irradiance", "group"});
  const bool by_sky_position = json.has("azimuth_deg") || json.has("elevation_deg");
  if (json.has("direction") == by_sky_position) {
    json.fail("expected either 'direction' or 'azimuth_deg' and 'elevation_deg'");
  }
  const auto read_direction = [&]() -> std::variant<Curve<3>, SkyPosition> {
    if (!by_sky_position) return read_direction_curve(json.at("direction"));
    return SkyPosition{read_number_curve(json.at("azimuth_deg"), -kLargestNumber, kLargestNumber),
                       read_number_curve(json.at("elevation_deg"), -90.0, 90.0)};
  };
  return {read_direction(),
          json.has("diameter_deg") ? read_number_curve(json.at("diameter_deg"), 0.0, 180.0)
                                   : Curve<1>(Curve<1>::Value{kSunDiameterDeg}),
          read_light_curve(json.at("irradiance")), read_light_group(json, scene.light_groups)};
}

LightDescription read_light(const JsonValue& json, SceneDescription& scene) {
  switch (json.at("type").choice({"point", "spot", "sun"})) {
    case 0:
      return read_point(json, scene);
    case 1:
      return read_spot(json, scene);
    default:
      return read_sun(json, scene);
  }
}

}  // namespace

void read_lights(const JsonValue& json, SceneDescription& scene) {
  if (json.is_object()) {
    for (const auto& [name, value] : json.members()) scene.lights.push_back(read_light(value, scene));
  } else {
    for (const JsonValue& value : json.elements()) scene.lights.push_back(read_light(value, scene));
  }
}

void read_environment(const JsonValue& json, SceneDescription& scene) {
  if (json.has("image")) {
    json.allow_keys({"image", "scale", "rotate_y_deg", "group"});
    const JsonValue image = json.at("image");
    const double scale = json.has("scale") ? json.at("scale").number(0.0, kLargestNumber) : 1.0;
    const double rotation = json.has("rotate_y_deg") ? json.at("rotate_y_deg").number() : 0.0;
    const Image pixels = read_image(image, beside(scene.file, image.string()));
    if (pixels.channels() == 2) image.fail("expected 1 or at least 3 channels, found 2");
    scene.environment = Environment::image(pixels, static_cast<float>(scale), static_cast<float>(rotation));
    scene.environment_is_image = true;
  } else {
    json.allow_keys({"radiance", "group"});
    scene.environment = Environment::constant(read_color(json.at("radiance"), kLargestNumber));
  }
  scene.environment_group = read_light_group(json, scene.light_groups);
}

}  // namespace becalm::tracer
