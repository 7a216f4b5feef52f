#include "tracer/scene/load/load_sections.h"

namespace becalm::tracer {

FrameRange read_frames(const JsonValue& json) {
  json.allow_keys({"first", "last", "rate"});
  constexpr int furthest = 1'000'000'000;
  FrameRange frames;
  frames.first = json.at("first").integer(-furthest, furthest);
  frames.last = json.at("last").integer(frames.first, furthest);
  constexpr std::int64_t most_frames = 1'000'000;
  if (std::int64_t{frames.last} - frames.first >= most_frames)
    json.at("last").fail(fmt::format("expected at most {} frames", most_frames));
  if (const auto rate = json.find("rate")) frames.rate = rate->number(1e-3, 1e6);
  return frames;
}

Film read_film(const JsonValue& json) {
  json.allow_keys({"width", "height", "filter", "jitter_cycle", "jitter_one_a_frame"});
  constexpr int largest_size = 65536;
  Film film;
  film.width = json.at("width").integer(1, largest_size);
  film.height = json.at("height").integer(1, largest_size);
  if (const auto filter = json.find("filter")) {
    filter->allow_keys({"type", "radius_px"});
    film.filter.type =
        static_cast<FilterShape>(filter->at("type").choice({"blackman_harris", "box", "tent"}));
    if (const auto radius = filter->find("radius_px")) film.filter.radius_px = radius->number(0.0, 32.0);
  }
  if (const auto one = json.find("jitter_one_a_frame")) film.jitter.one_a_frame = one->boolean();
  if (const auto cycle = json.find("jitter_cycle")) film.jitter.cycle = cycle->integer(0, 1'000'000);
  return film;
}

Integrator read_integrator(const JsonValue& json) {
  json.allow_keys({"max_depth", "roulette_depth", "direct", "heuristic"});
  Integrator integrator;
  if (const auto v = json.find("max_depth")) integrator.max_depth = v->integer(0, 100'000);
  if (const auto v = json.find("roulette_depth")) integrator.roulette_depth = v->integer(0, 100'000);
  if (const auto v = json.find("direct"))
    integrator.direct = static_cast<Direct>(v->choice({"mis", "light", "material"}));
  if (const auto v = json.find("heuristic")) {
    integrator.heuristic = static_cast<Heuristic>(v->choice({"power", "balance"}));
  }
  return integrator;
}

}  // namespace becalm::tracer
