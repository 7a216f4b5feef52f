#include <algorithm>
#include <span>
#include <variant>
#include <vector>

#include "tracer/scene/load/load_sections.h"
#include "tracer/scene/load/scatter.h"

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
      if (static_cast<float>(value[i]) == 0.0f)
        v->fail("a scale must not be 0, nor less than floats hold (1.4e-45)");
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

bool scales_alike(const TransformCurve& transform) {
  return std::ranges::all_of(transform.keys(), [](const TransformCurve::Key& key) {
    return std::abs(key.value[6]) == std::abs(key.value[7]) &&
           std::abs(key.value[7]) == std::abs(key.value[8]);
  });
}

/// What materials may ask of a surface and an object's shape does not have. The parts of a mix count.
void check_material_fits(const JsonValue& json, const Object& object, const SceneDescription& scene) {
  const Material& material = scene.materials[object.material];
  const auto& shape = scene.meshes[object.mesh];
  if (has_alpha(material) && !std::holds_alternative<Mesh>(shape))
    json.at("material").fail("only triangles can have an opacity");
  if (has_alpha(material) && object.interior)
    json.at("interior").fail("a material with an opacity bounds no medium: it would leak through the holes");
  const auto* mesh = std::get_if<Mesh>(&shape);
  const bool is_procedural = std::holds_alternative<ProceduralDescription>(shape);
  // What an MTL file says of a mesh without uvs is ignored, as other renderers do.
  if (!is_procedural && !(mesh && mesh->uvs.empty() && json.has("material"))) return;
  if (mesh && material.opacity_mask) json.at("material").fail("the mesh has no uvs for an opacity image");
  const MaterialNeeds needs = material_needs(scene.materials, material);
  if (needs.relief) {
    json.at("material")
        .fail(is_procedural ? "a procedural surface has no uvs for bump and normal maps"
                            : "the mesh has no uvs for bump and normal maps");
  }
  if (mesh && needs.textures) json.at("material").fail("the mesh has no uvs for images");
}

bool turns(const TransformCurve& transform) {
  const auto rotation = [](const TransformCurve::Key& key) { return std::span(key.value).subspan(3, 3); };
  return std::ranges::any_of(transform.keys(), [&](const TransformCurve::Key& key) {
    return !std::ranges::equal(rotation(key), rotation(transform.keys().front()));
  });
}

/// Throws for combinations that are not supported. Removes the rotation of emissive spheres that turn in a
/// scene with motion blur, which is linear between transforms and would shrink them.
void check_fits(const JsonValue& json, Object& object, const SceneDescription& scene) {
  const Material& material = scene.materials[object.material];
  if (material.is_interface && object.emissive)
    json.at("emission").fail("an interface has no surface that could emit");
  check_material_fits(json, object, scene);
  if (!object.emissive || std::holds_alternative<Mesh>(scene.meshes[object.mesh])) return;
  if (!std::holds_alternative<UnitSphere>(scene.meshes[object.mesh]))
    json.at("emission").fail("only triangles and exact spheres can emit");
  if (!scales_alike(object.transform))
    json.at("transform").fail("an exact sphere that emits must be scaled alike in x, y and z");
  if (!scene.camera.shutter.blurs() || !turns(object.transform)) return;
  std::vector<TransformCurve::Key> keys = object.transform.keys();
  for (TransformCurve::Key& key : keys) std::fill_n(key.value.begin() + 3, 3, 0.0);
  object.transform = TransformCurve(std::move(keys), object.transform.interpolation());
}

/// What objects of one mesh or of several parts share.
Object read_shared(const JsonValue& json, const SceneNames& names) {
  json.allow_keys(
      {"name", "mesh", "material", "interior", "emission", "group", "two_sided", "transform", "scatter"});
  Object object;
  if (const auto name = json.find("name")) object.name = name->string();
  object.mesh = read_reference(json.at("mesh"), names.meshes, "mesh");
  if (const auto emission = json.find("emission"))
    object.emission = read_triple_curve(*emission, 0.0, kLargestNumber);
  if (const auto interior = json.find("interior"))
    object.interior = read_reference(*interior, names.media, "medium");
  if (const auto two_sided = json.find("two_sided")) object.two_sided = two_sided->boolean();
  if (const auto transform = json.find("transform")) object.transform = read_transform(*transform);
  return object;
}

/// Settles whether the object emits, and in which light group.
void finish_emission(const JsonValue& json, Object& object, SceneDescription& scene) {
  object.emissive = std::ranges::any_of(object.emission.keys(), [](const Curve<3>::Key& key) {
    return key.value != Curve<3>::Value{0, 0, 0};
  });
  if (object.emissive) object.light_group = read_light_group(json, scene.light_groups);
}

/// The object, or one for each part of its mesh.
std::vector<Object> read_parts(const JsonValue& json, const SceneNames& names, SceneDescription& scene) {
  Object object = read_shared(json, names);
  const auto parts = names.parts.find(object.mesh);
  std::vector<Object> objects;
  if (parts == names.parts.end()) {
    object.material = read_reference(json.at("material"), names.materials, "material");
    objects.push_back(std::move(object));
  } else {
    for (const char* key : {"material", "emission"}) {
      if (json.has(key)) json.at(key).fail("the mesh brings its own materials (\"materials\": \"mtl\")");
    }
    for (const MeshPart& part : parts->second) {
      Object& made = objects.emplace_back(object);
      made.mesh = part.mesh;
      made.material = part.material;
      made.emission = Curve<3>::Value{part.emission.x, part.emission.y, part.emission.z};
    }
  }
  for (Object& made : objects) {
    finish_emission(json, made, scene);
    check_fits(json, made, scene);
  }
  if (json.has("group") && std::ranges::none_of(objects, &Object::emissive))
    json.at("group").fail("only what emits is of a light group");
  return objects;
}

Scatter read_scatter(const JsonValue& json) {
  json.allow_keys({"count", "seed", "area", "scale", "tilt_deg", "on"});
  constexpr int most_copies = 10'000'000;
  Scatter scatter;
  scatter.count = static_cast<std::uint32_t>(json.at("count").integer(1, most_copies));
  if (const auto v = json.find("seed"))
    scatter.seed = static_cast<std::uint32_t>(v->integer(0, 1'000'000'000));
  const auto area = json.at("area").numbers<4>(-kLargestCoordinate, kLargestCoordinate);
  if (!(area[0] < area[2] && area[1] < area[3]))
    json.at("area").fail("expected [x0, z0, x1, z1] with x0 < x1 and z0 < z1");
  scatter.x0 = area[0];
  scatter.z0 = area[1];
  scatter.x1 = area[2];
  scatter.z1 = area[3];
  if (const auto v = json.find("scale")) {
    const auto range = v->numbers<2>(std::numeric_limits<float>::min(), kLargestNumber);
    if (range[0] > range[1]) v->fail("expected [smallest, largest]");
    scatter.scale_low = range[0];
    scatter.scale_high = range[1];
  }
  if (const auto v = json.find("tilt_deg")) scatter.tilt_deg = v->number(0.0, 180.0);
  return scatter;
}

/// Whether the shape itself is animated.
bool changes(const Geometry& shape) {
  const auto* procedural = std::get_if<ProceduralDescription>(&shape);
  if (procedural == nullptr) return false;
  struct Changes {
    bool operator()(const TerrainDescription& t) const { return t.height.animated() || t.erosion.animated(); }
    bool operator()(const OceanDescription& o) const {
      return o.wave_height.animated() || o.time_s.animated();
    }
    bool operator()(const BlobsDescription& b) const { return b.radius.animated() || b.time_s.animated(); }
  };
  return std::visit(Changes(), *procedural);
}

/// The earlier object of that name, with all parts of its mesh.
std::vector<Object> read_ground(const JsonValue& json, const SceneDescription& scene) {
  const std::string name = json.string();
  std::vector<Object> parts;
  std::ranges::copy_if(scene.objects, std::back_inserter(parts),
                       [&](const Object& object) { return object.name == name; });
  if (parts.empty()) json.fail(fmt::format("no object '{}' before this one", name));
  const auto moves = [&](const Object& part) {
    return part.transform.animated() || changes(scene.meshes[part.mesh]);
  };
  if (std::ranges::any_of(parts, moves)) json.fail(fmt::format("the object '{}' moves", name));
  return parts;
}

}  // namespace

void read_object(const JsonValue& json, const SceneNames& names, SceneDescription& scene) {
  std::vector<Object> objects = read_parts(json, names, scene);
  const auto settings = json.find("scatter");
  if (!settings) {
    std::ranges::move(objects, std::back_inserter(scene.objects));
    return;
  }
  if (objects.front().transform.animated()) json.at("transform").fail("what is scattered must stand still");
  const Scatter scatter = read_scatter(*settings);
  const auto on = settings->find("on");
  const std::vector<Object> ground = on ? read_ground(*on, scene) : std::vector<Object>();
  for (const Object& object : objects) {
    std::ranges::move(scattered_copies(object, scatter, scene, ground), std::back_inserter(scene.objects));
  }
}

}  // namespace becalm::tracer
