#include "tracer/scene/load_sections.h"

namespace becalm::tracer {

namespace {

TransformCurve::Value read_transform_value(const JsonValue& json) {
  TransformCurve::Value value{0, 0, 0, 0, 0, 0, 1, 1, 1};
  const auto store = [&](const std::array<double, 3>& v, std::size_t first) {
    std::copy(v.begin(), v.end(), value.begin() + first);
  };
  if (const auto v = json.find("translate")) store(v->numbers<3>(), 0);
  if (const auto v = json.find("rotate_deg")) store(v->numbers<3>(), 3);
  if (const auto v = json.find("scale")) {
    store(v->triple(-kLargestNumber, kLargestNumber), 6);
    for (std::size_t i = 6; i < 9; ++i) {
      if (value[i] == 0.0) v->fail("a scale must not be 0");
    }
  }
  return value;
}

TransformCurve read_transform(const JsonValue& json) {
  if (!json.has("keys")) {
    json.allow_keys({"translate", "rotate_deg", "scale"});
    return read_transform_value(json);
  }
  TransformCurve curve = read_keys<9>(json, [](const JsonValue& key) {
    key.allow_keys({"frame", "translate", "rotate_deg", "scale"});
    return read_transform_value(key);
  });
  for (const TransformCurve::Key& key : curve.keys()) {
    for (std::size_t i = 6; i < 9; ++i) {
      if (key.value[i] * curve.keys().front().value[i] < 0.0) {
        json.at("keys").fail("a scale must not change its sign between keys: it would pass through 0");
      }
    }
  }
  return curve;
}

}  // namespace

Object read_object(const JsonValue& json, const Names& meshes, const Names& materials) {
  json.allow_keys({"name", "mesh", "material", "emission", "two_sided", "transform"});
  Object object;
  if (const auto name = json.find("name")) object.name = name->string();
  object.mesh = read_reference(json.at("mesh"), meshes, "mesh");
  object.material = read_reference(json.at("material"), materials, "material");
  if (const auto emission = json.find("emission"))
    object.emission = read_triple_curve(*emission, 0.0, kLargestNumber);
  for (const Curve<3>::Key& key : object.emission.keys()) {
    object.emissive = object.emissive || key.value != Curve<3>::Value{0, 0, 0};
  }
  if (const auto two_sided = json.find("two_sided")) object.two_sided = two_sided->boolean();
  if (const auto transform = json.find("transform")) object.transform = read_transform(*transform);
  return object;
}

}  // namespace becalm::tracer
