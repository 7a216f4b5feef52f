#include "app/test/test_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "app/json_number.h"
#include "app/pictures.h"
#include "app/test/layer_as_beauty.h"
#include "app/test/shell_words.h"
#include "frame/error.h"
#include "frame/frame.h"

extern const char becalm_page_skeleton[];
extern const char becalm_page_skeleton_end[];
extern const char becalm_test_page[];
extern const char becalm_test_page_end[];

namespace becalm::app {
namespace {

using Json = nlohmann::ordered_json;

/// Pictured frames of a case: those that failed, or else the first ones.
constexpr std::size_t kMostFrames = 4;
/// Larger pictures are averaged down by whole factors.
constexpr int kWidestPicture = 960;
/// The scores are of 5x5 pixels.
constexpr int kScoreRadius = 2;

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? letters[bits >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

std::string data_url(const Picture& picture) {
  return "data:image/png;base64," + base64(png_bytes(picture));
}

/// Means of `factor` x `factor` pixels; what is left at the right and at the bottom is cut off.
Image shrunk(const Image& image, int factor) {
  if (factor == 1) return image;
  Image small(std::max(1, image.width() / factor), std::max(1, image.height() / factor), image.channels());
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      for (int c = 0; c < image.channels(); ++c) {
        double sum = 0.0;
        for (int v = 0; v < factor; ++v) {
          for (int u = 0; u < factor; ++u) {
            sum += image.at(std::min(x * factor + u, image.width() - 1),
                            std::min(y * factor + v, image.height() - 1), c);
          }
        }
        small.at(x, y, c) = static_cast<float>(sum / (double(factor) * factor));
      }
    }
  }
  return small;
}

/// The difference of the pixels around each in standard deviations of both images' own noise: of a single
/// pixel the noise would hide what a block shows.
Image scores_of(const Frame& test, const Frame& reference) {
  const Image& mean = test.image(Aov::beauty);
  Image scores(mean.width(), mean.height(), 3);
  for (int y = 0; y < mean.height(); ++y) {
    for (int x = 0; x < mean.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        double difference = 0.0;
        double variance = 0.0;
        for (int v = std::max(0, y - kScoreRadius); v < std::min(mean.height(), y + kScoreRadius + 1); ++v) {
          for (int u = std::max(0, x - kScoreRadius); u < std::min(mean.width(), x + kScoreRadius + 1); ++u) {
            difference += double(mean.at(u, v, c)) - reference.image(Aov::beauty).at(u, v, c);
            variance +=
                double(test.image(Aov::variance).at(u, v, c)) + reference.image(Aov::variance).at(u, v, c);
          }
        }
        scores.at(x, y, c) =
            difference == 0.0 ? 0.0f : static_cast<float>(difference / std::sqrt(std::max(0.0, variance)));
      }
    }
  }
  return scores;
}

/// Of the pictures of a frame: which they are, and how they are shown.
struct Pictures {
  Json by_kind = Json::object();
  Json facts = Json::object();
  std::string note;  ///< what could not be pictured
};

/// `layer` of the test frame is shown, its beauty if that is empty.
void add_pictures(const JudgedFrame& files, const std::string& layer, Pictures& pictures) {
  const Frame test =
      files.test.empty() ? Frame() : read_layer_as_beauty(files.test, files.number, layer).frame;
  const Frame reference =
      files.reference.empty() ? Frame() : read_layer_as_beauty(files.reference, files.number, "").frame;
  const Frame& known = reference.has(Aov::beauty) ? reference : test;
  if (!known.has(Aov::beauty)) return;
  const int factor = (known.width() + kWidestPicture - 1) / kWidestPicture;
  const double exposure = automatic_exposure(known.image(Aov::beauty));
  pictures.facts = {{"width", known.width()},
                    {"height", known.height()},
                    {"shrunk", factor},
                    {"stops", std::log2(exposure)}};
  const auto show = [&](const char* kind, const Frame& frame) {
    if (!frame.has(Aov::beauty)) return;
    pictures.by_kind[kind] = data_url(display_picture(shrunk(frame.image(Aov::beauty), factor), exposure));
  };
  show("reference", reference);
  show("result", test);
  if (!test.has(Aov::beauty) || !reference.has(Aov::beauty)) return;
  if (test.width() != reference.width() || test.height() != reference.height()) {
    pictures.note = fmt::format("the result is {}x{}, and its reference {}x{}", test.width(), test.height(),
                                reference.width(), reference.height());
    return;
  }
  pictures.by_kind["difference"] = data_url(
      error_picture(shrunk(test.image(Aov::beauty), factor), shrunk(reference.image(Aov::beauty), factor)));
  if (test.has(Aov::variance) && reference.has(Aov::variance)) {
    pictures.by_kind["z-scores"] = data_url(score_picture(shrunk(scores_of(test, reference), factor)));
  }
}

Json frame_json(const JudgedFrame& files, const std::string& layer) {
  Pictures pictures;
  if (files.reference.empty()) pictures.note = "there is no reference";
  if (files.test.empty()) pictures.note = "this frame was not made";
  try {
    add_pictures(files, layer, pictures);
  } catch (const Error& error) {
    if (error.status() == ExitStatus::resource) throw;
    pictures.note = error.what();
  }
  Json json = pictures.facts;
  json["number"] = files.number;
  json["pictures"] = pictures.by_kind;
  if (!pictures.note.empty()) json["note"] = pictures.note;
  return json;
}

/// The frames that failed, or all if none did, in their order; at most kMostFrames.
std::vector<const JudgedFrame*> pictured_frames(const CaseResult& result) {
  std::set<int> failed = result.unjudged;
  for (const CheckResult& check : result.checks) {
    if (!check.passed && check.frame) failed.insert(*check.frame);
  }
  std::vector<const JudgedFrame*> frames;
  for (const JudgedFrame& frame : result.frames) {
    if (failed.empty() || failed.contains(frame.number)) frames.push_back(&frame);
  }
  if (frames.size() > kMostFrames) frames.resize(kMostFrames);
  return frames;
}

Json case_json(const CaseResult& result) {
  Json json{{"name", result.suite + "/" + result.name},
            {"outcome", name_of(result.outcome)},
            {"messages", result.messages},
            {"seconds", result.seconds},
            {"memory_mib", static_cast<double>(result.peak_memory_bytes) / 1048576.0},
            {"checks", Json::array()}};
  for (const CheckResult& check : result.checks) {
    json["checks"].push_back({{"judge", check.judge},
                              {"figure", check.figure},
                              {"frame", check.frame ? Json(*check.frame) : Json()},
                              {"value", json_number(check.value)},
                              {"limit", json_number(check.limit)},
                              {"passed", check.passed}});
  }
  if (result.outcome != CaseOutcome::failed && result.outcome != CaseOutcome::error) return json;
  json["replay"] = fmt::format("becalm test {} --filter {}", shell_word(result.suite_file),
                               shell_word(result.suite + "/" + result.name));
  json["command"] = result.command;
  json["output"] = result.output;
  json["frames"] = Json::array();
  const std::vector<const JudgedFrame*> frames = pictured_frames(result);
  for (const JudgedFrame* frame : frames) json["frames"].push_back(frame_json(*frame, result.layer));
  json["frame_count"] = result.frames.size();
  return json;
}

/// Replaces the only occurrence.
void replace(std::string& text, std::string_view place, std::string_view value) {
  const std::size_t at = text.find(place);
  if (at == std::string::npos) throw std::logic_error(fmt::format("the page has no {}", place));
  text.replace(at, place.size(), value);
}

}  // namespace

std::string test_page(const TestResults& results) {
  Json data{{"seconds", results.seconds},
            {"coolest", kCoolestError},
            {"hottest", kHottestError},
            {"largest_score", kLargestScore},
            {"error_colours", error_scale_css()},
            {"score_colours", score_scale_css()},
            {"cases", Json::array()}};
  for (const CaseResult& result : results.cases) data["cases"].push_back(case_json(result));
  // What a command printed need not be UTF-8.
  std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  // In a script element only "</" and "<!--" could end or hide the data.
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 6)
    text.replace(at, 1, "\\u003c");

  const std::string_view content(becalm_test_page, becalm_test_page_end);
  constexpr std::string_view end_of_style = "</style>\n";
  const std::size_t body = content.find(end_of_style) + end_of_style.size();
  std::string page(becalm_page_skeleton, becalm_page_skeleton_end);
  replace(page, "__TITLE__", "regression tests");
  replace(page, "__STYLE__", content.substr(0, body));
  replace(page, "__CONTENT__", content.substr(body));
  replace(page, "__DATA__", text);
  return page;
}

}  // namespace becalm::app
