// Time of rendering: against the time of the ray queries alone, with more threads, with each need of a scene;
// memory of the geometry.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "frame/error.h"
#include "scripts/benches/stopwatch.h"
#include "scripts/benches/tracer/minimal_integrator.h"
#include "scripts/benches/tracer/ray_floor.h"
#include "tests/scratch_folder.h"
#include "tracer/scene/load/load.h"

namespace becalm::bench {
namespace {

using namespace becalm::tracer;

constexpr int kRuns = 5;

RenderOptions frame_options() {
  RenderOptions options;
  options.spp = 4;
  return options;
}

void print_memory(const Snapshot& snapshot) {
  const GeometrySize size = snapshot.intersector().size();
  if (size.stored_triangles == 0) return;
  fmt::print("    {} triangles stored, {} visible; {:.0f} bytes a triangle by Embree's count ({:.1f} MiB)\n",
             size.stored_triangles, size.visible_triangles,
             static_cast<double>(size.embree_bytes) / static_cast<double>(size.stored_triangles),
             static_cast<double>(size.embree_bytes) / 1048576.0);
}

/// Prints the frame's time over that of its ray queries alone.
void measure_floor(const std::string& file) {
  Scene scene = load_scene(file);
  const RenderOptions options = frame_options();
  const int frame = (scene.description().frames.first + scene.description().frames.last) / 2;
  const Snapshot& snapshot = scene.at_frame(frame);
  const RayFloor floor(scene, frame, options);
  Runs render, replay;
  for (int i = 0; i < kRuns; ++i) {
    render.add(time_of([&] { render_frame(scene, frame, options); }));
    replay.add(floor.replay(snapshot.intersector()));
  }
  fmt::print(
      "{:<22} {:>6.2f} s, rays alone {:>6.2f} s: {:.2f}x; {:.1f} million rays ({:.0f}% shadow), {:.1f} a "
      "second; variant {}\n",
      std::filesystem::path(file).filename().string(), render.middle().wall_s, replay.middle().wall_s,
      render.ratio_to(replay), static_cast<double>(floor.rays()) * 1e-6, 100.0 * floor.occlusion_share(),
      static_cast<double>(floor.rays()) * 1e-6 / render.middle().wall_s,
      select_path_variant(scene.needs(), false).name);
  print_memory(snapshot);
}

void measure_threads(const std::string& file) {
  Scene scene = load_scene(file);
  const int frame = scene.description().frames.first;
  scene.at_frame(frame);
  const auto with_threads = [&](int count) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
    return time_of([&] { render_frame(scene, frame, frame_options()); });
  };
  std::vector<double> speedups;
  for (int i = 0; i < kRuns; ++i) {
    const double one = with_threads(1).wall_s;
    speedups.push_back(one / with_threads(2).wall_s);
  }
  fmt::print("{:<22} 1 to 2 threads: {:.2f}x\n", std::filesystem::path(file).filename().string(),
             median(speedups));
}

/// A diffuse room under a lamp, which has no further needs.
nlohmann::json simple_room() {
  return nlohmann::json::parse(R"({
    "film": {"width": 640, "height": 360},
    "integrator": {"max_depth": 5, "roulette_depth": 4},
    "camera": {"fov_y_deg": 60, "look_at": {"eye": [0, 1, 3.9], "target": [0, 0.8, 0]}},
    "materials": {"white": {"type": "diffuse", "reflectance": 0.7}, "ball": {"type": "diffuse", "reflectance": [0.6, 0.3, 0.2]}},
    "meshes": {"square": {"shape": "rectangle"}, "ball": {"shape": "sphere", "segments": 128}, "cube": {"shape": "cube"}},
    "objects": [
      {"name": "floor", "mesh": "square", "material": "white", "transform": {"scale": 4}},
      {"name": "ceiling", "mesh": "square", "material": "white", "transform": {"scale": 4, "rotate_deg": [180, 0, 0], "translate": [0, 4, 0]}},
      {"name": "back", "mesh": "square", "material": "white", "transform": {"scale": 4, "rotate_deg": [90, 0, 0], "translate": [0, 2, -4]}},
      {"name": "left", "mesh": "square", "material": "white", "transform": {"scale": 4, "rotate_deg": [0, 0, -90], "translate": [-4, 2, 0]}},
      {"name": "right", "mesh": "square", "material": "white", "transform": {"scale": 4, "rotate_deg": [0, 0, 90], "translate": [4, 2, 0]}},
      {"name": "front", "mesh": "square", "material": "white", "transform": {"scale": 4, "rotate_deg": [-90, 0, 0], "translate": [0, 2, 4]}},
      {"name": "lamp", "mesh": "square", "material": "white", "emission": 12, "transform": {"scale": 0.6, "rotate_deg": [180, 0, 0], "translate": [0, 3.9, 0]}},
      {"name": "ball", "mesh": "ball", "material": "ball", "transform": {"scale": 0.7, "translate": [-1, 0.7, 0]}},
      {"name": "other ball", "mesh": "ball", "material": "ball", "transform": {"scale": 0.4, "translate": [0.9, 0.4, 1]}},
      {"name": "box", "mesh": "cube", "material": "ball", "transform": {"scale": 0.5, "rotate_deg": [0, 30, 0], "translate": [1, 0.5, -1]}}
    ]})");
}

/// A need: a value that is put into the room's JSON at a pointer.
struct Need {
  const char* name;
  const char* pointer;
  const char* value;
  bool guides = false;
};

constexpr Need kNeeds[] = {
    {"glass ball", "/materials/ball", R"({"type": "dielectric"})"},
    {"rough metal", "/materials/ball", R"({"type": "conductor", "reflectance": 0.8, "roughness": 0.4})"},
    {"principled", "/materials/ball", R"({"type": "principled", "base_color": 0.5, "roughness": 0.3})"},
    {"depth of field", "/camera/aperture_radius", "0.05"},
    {"camera blur", "/camera", R"({"fov_y_deg": 60, "shutter": [0, 0.5], "look_at": {"keys": [
        {"frame": 0, "eye": [0, 1, 3.9], "target": [0, 0.8, 0]}, {"frame": 4, "eye": [0.2, 1, 3.9], "target": [0, 0.8, 0]}]}})"},
    {"half-transparent box", "/materials/ball/opacity", "0.5"},
    {"guide AOVs", "/film/height", "360", true},
};

Scene load(const nlohmann::json& json, const ScratchFolder& folder) {
  return load_scene(folder.write("bench.json", json.dump()));
}

/// Prints the time of the simple room by each variant of the integrator, and its time with each need.
void measure_needs() {
  const ScratchFolder folder;
  Scene scene = load(simple_room(), folder);
  scene.at_frame(1);
  std::vector<RenderOptions> ways;
  ways.emplace_back(frame_options()).variant = &kMinimalVariant;
  std::vector<std::string> names = {"minimal integrator, by hand"};
  for (const PathVariant& variant : path_variants(false)) {
    ways.emplace_back(frame_options()).variant = &variant;
    names.push_back(fmt::format("variant '{}'", variant.name));
  }
  std::vector<Runs> runs(ways.size());
  for (int i = 0; i < 2 * kRuns + 1; ++i) {
    for (std::size_t w = 0; w < ways.size(); ++w)
      runs[w].add(time_of([&] { render_frame(scene, 1, ways[w]); }));
  }
  fmt::print("\nthe simple room, which needs the variant '{}':\n",
             select_path_variant(scene.needs(), false).name);
  for (std::size_t w = 0; w < ways.size(); ++w) {
    fmt::print("  {:<28} {:.3f} s, {:+.1f}%\n", names[w], runs[w].middle().processor_s,
               100.0 * (runs[w].ratio_to(runs[0]) - 1.0));
  }

  fmt::print("with one more need:\n");
  for (const Need& need : kNeeds) {
    nlohmann::json json = simple_room();
    json[nlohmann::json::json_pointer(need.pointer)] = nlohmann::json::parse(need.value);
    Scene other = load(json, folder);
    RenderOptions options = frame_options();
    if (need.guides)
      options.aovs.set(static_cast<std::size_t>(Aov::albedo)).set(static_cast<std::size_t>(Aov::motion));
    other.at_frame(1);
    Runs with, without;
    for (int i = 0; i < kRuns; ++i) {
      without.add(time_of([&] { render_frame(scene, 1, frame_options()); }));
      with.add(time_of([&] { render_frame(other, 1, options); }));
    }
    fmt::print("  {:<28} {:.3f} s, {:+.1f}%, variant '{}'\n", need.name, with.middle().processor_s,
               100.0 * (with.ratio_to(without) - 1.0), select_path_variant(other.needs(), need.guides).name);
  }
}

void run_scenes(const std::vector<std::string>& scenes) {
  for (const std::string& scene : scenes) measure_floor(scene);
  fmt::print("\n");
  measure_threads(scenes.front());
}

/// arguments: the word `needs`, or scene files.
int run(const std::vector<std::string>& arguments) {
  if (arguments.empty()) throw Error(ExitStatus::usage, "expected the word needs, or scenes");
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // each line appears when it is measured
  fmt::print(
      "one frame at the scene's size, 4 samples a pixel; medians of {} runs; ratios of processor time\n",
      kRuns);
  if (arguments.front() == "needs") {
    measure_needs();
  } else {
    run_scenes(arguments);
  }
  return 0;
}

}  // namespace
}  // namespace becalm::bench

int main(int argc, char** argv) {
  try {
    return becalm::bench::run({argv + 1, argv + argc});
  } catch (const becalm::Error& error) {
    std::fprintf(stderr, "bench_tracer: %s\n", error.what());
    return static_cast<int>(error.status());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_tracer: %s\n", error.what());
    return 4;
  }
}
