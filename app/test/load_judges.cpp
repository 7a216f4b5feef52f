#include "app/test/load_judges.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "filter/settings.h"

namespace becalm::app {
namespace {

using tracer::JsonValue;

/// A limit of the suite file: its judge, its key and the figure that it bounds.
struct LimitKey {
  std::string_view judge;
  std::string_view key;
  double FrameFigures::*value;
};

constexpr std::array kLimitKeys{
    LimitKey{"perceptual", "max_flip", &FrameFigures::flip},
    LimitKey{"perceptual", "min_ssim", &FrameFigures::ssim},
    LimitKey{"error", "max_rel_mse", &FrameFigures::rel_mse},
    LimitKey{"error", "max_temporal_error", &FrameFigures::temporal},
    LimitKey{"error", "max_energy", &FrameFigures::energy},
};

const Figure& figure_of(double FrameFigures::*value) {
  return *std::ranges::find(kFigures, value, &Figure::value);
}

double read_limit(const JsonValue& json, double most) {
  const double limit = json.number(0.0);
  if (limit > most) json.fail(fmt::format("expected a number of at most {}, found {}", most, limit));
  return limit;
}

/// The limits among the members of a judge; `judge` empty: those of perceptual and error alike.
std::vector<FigureLimit> read_limits(const JsonValue& json, std::string_view judge) {
  std::vector<FigureLimit> limits;
  for (const LimitKey& entry : kLimitKeys) {
    if (!judge.empty() && entry.judge != judge) continue;
    if (const auto limit = json.find(entry.key)) {
      const Figure& figure = figure_of(entry.value);
      limits.push_back({&figure, std::string(judge.empty() ? "denoised" : judge), std::string(entry.key),
                        read_limit(*limit, figure.most)});
    }
  }
  if (limits.empty()) json.fail("expected at least one limit");
  return limits;
}

bool is_false(const JsonValue& json) {
  return !json.is_object() && !json.boolean();
}

/// `true` stands for an object without members.
template <class Judge, class ReadMembers>
void read_judge(const JsonValue& judges, std::string_view key, std::optional<Judge>& judge,
                const ReadMembers& read_members) {
  const auto json = judges.find(key);
  if (!json) return;
  judge.reset();
  if (is_false(*json)) return;
  judge.emplace();
  read_members(*json, *judge);
}

void read_exact(const JsonValue& json, ExactJudge& exact) {
  if (!json.is_object()) return;
  json.allow_keys({"max_ulps"});
  constexpr int most = 1 << 24;
  if (const auto ulps = json.find("max_ulps")) exact.max_ulps = ulps->integer(0, most);
}

void read_denoised(const JsonValue& json, DenoisedJudge& denoised) {
  json.allow_keys({"preset", "max_flip", "min_ssim", "max_rel_mse", "max_temporal_error", "max_energy"});
  if (const auto preset = json.find("preset")) {
    preset->choice(filter::kPresets);
    denoised.preset = preset->string();
  }
  denoised.limits = read_limits(json, "");
}

void read_sequence(const JsonValue& json, SequenceJudge& sequence) {
  json.allow_keys({"max_temporal_error", "max_flicker"});
  if (const auto limit = json.find("max_temporal_error")) sequence.max_temporal_error = limit->number(0.0);
  if (const auto limit = json.find("max_flicker")) sequence.max_flicker = limit->number(0.0);
  if (!sequence.max_temporal_error && !sequence.max_flicker) json.fail("expected at least one limit");
}

bool has_consecutive(const std::vector<int>& frames) {
  return std::ranges::adjacent_find(frames, [](int a, int b) { return b == a + 1; }) != frames.end();
}

}  // namespace

void read_judges(const JsonValue& json, Judges& judges) {
  json.allow_keys({"exact", "statistical", "denoised", "perceptual", "error", "sequence"});
  read_judge(json, "exact", judges.exact, read_exact);
  if (const auto statistical = json.find("statistical")) judges.statistical = statistical->boolean();
  read_judge(json, "denoised", judges.denoised, read_denoised);
  read_judge(json, "sequence", judges.sequence, read_sequence);
  for (const char* judge : {"perceptual", "error"}) {
    const auto members = json.find(judge);
    if (!members) continue;
    std::erase_if(judges.limits, [&](const FigureLimit& limit) { return limit.judge == judge; });
    if (is_false(*members)) continue;
    std::string_view(judge) == "error"
        ? members->allow_keys({"max_rel_mse", "max_temporal_error", "max_energy"})
        : members->allow_keys({"max_flip", "min_ssim"});
    std::ranges::move(read_limits(*members, judge), std::back_inserter(judges.limits));
  }
}

void check_judges(const JsonValue& json, const TestCase& test) {
  const Judges& judges = test.judges;
  const CaseSource& source = test.source;
  if (judges.empty()) json.fail("expected at least one judge in 'judged_by'; nothing would be checked");
  if (judges.exact && judges.statistical) {
    json.fail(
        "exact and statistical exclude each other: one needs a reference of the same seed, the other an "
        "independent one");
  }
  if (judges.statistical && !source.preset.empty()) {
    json.fail("statistical needs frames that are not denoised; a filter correlates their pixels");
  }
  if (judges.denoised && !source.preset.empty()) {
    json.fail("denoised needs frames that the source has not denoised; leave out its 'denoise'");
  }
  if (!test.layer.empty() && (judges.exact || judges.statistical || judges.denoised)) {
    json.fail("a 'layer' is judged by perceptual, error and sequence alone");
  }
  const auto is_temporal = [](const FigureLimit& limit) {
    return limit.figure->value == &FrameFigures::temporal;
  };
  const bool temporal = judges.sequence || std::ranges::any_of(judges.limits, is_temporal) ||
                        (judges.denoised && std::ranges::any_of(judges.denoised->limits, is_temporal));
  if (temporal && !has_consecutive(source.frames)) {
    json.fail("a limit over time needs frames that follow each other, such as \"frames\": \"1-4\"");
  }
}

}  // namespace becalm::app
