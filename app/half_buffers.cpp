#include "app/half_buffers.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <system_error>

#include "frame/error.h"

namespace becalm::app {
namespace {

/// The name with `.b0.` where it has `.b1.`, or the other way round; empty where it has neither.
std::string other_name(std::string name) {
  for (const auto& [own, other] : {std::pair{".b0.", ".b1."}, {".b1.", ".b0."}}) {
    const std::size_t at = name.rfind(own);
    if (at != std::string::npos) return name.replace(at, std::string_view(own).size(), other);
  }
  return "";
}

/// RGB of a beauty.
Image radiance_of(const Image& beauty) {
  Image radiance(beauty.width(), beauty.height(), 3);
  for (std::size_t i = 0; i < beauty.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) radiance.data()[3 * i + c] = beauty.data()[4 * i + c];
  }
  return radiance;
}

void take_mean(Image& image, const Image& other) {
  for (std::size_t i = 0; i < image.data().size(); ++i) {
    float& value = image.data()[i];
    // Equal values, infinite ones among them, stay bit for bit.
    if (value != other.data()[i]) value = 0.5f * value + 0.5f * other.data()[i];
  }
}

bool are_alike(const io::LoadedView& a, const io::LoadedView& b) {
  return a.view == b.view && a.frame.width() == b.frame.width() && a.frame.height() == b.frame.height() &&
         a.frame.aovs() == b.frame.aovs() && a.frame.light_groups().size() == b.frame.light_groups().size();
}

void join(io::LoadedView& first, const io::LoadedView& second) {
  Frame& frame = first.frame;
  frame.image(Aov::half_a) = radiance_of(frame.image(Aov::beauty));
  frame.image(Aov::half_b) = radiance_of(second.frame.image(Aov::beauty));
  frame.remove(Aov::variance);
  for (const Aov aov : {Aov::beauty, Aov::albedo, Aov::normal, Aov::direct, Aov::indirect}) {
    if (frame.has(aov)) take_mean(frame.image(aov), second.frame.image(aov));
  }
  for (std::size_t i = 0; i < frame.light_groups().size(); ++i) {
    take_mean(frame.light_groups()[i].radiance, second.frame.light_groups()[i].radiance);
  }
}

}  // namespace

std::optional<io::SequencePattern> find_other_half(const io::SequencePattern& first) {
  const std::filesystem::path path(first.text());
  const std::string name = other_name(path.filename().string());
  if (name.empty()) return std::nullopt;
  const std::string text = (path.parent_path() / name).string();
  io::SequencePattern other =
      first.padding() > 0 ? io::SequencePattern(text, first.padding()) : io::SequencePattern(text);
  std::error_code error;
  const bool is_there =
      other.has_frame_field() ? !other.frames_on_disk().empty() : std::filesystem::exists(text, error);
  return is_there ? std::optional(std::move(other)) : std::nullopt;
}

void join_halves(io::LoadedFrame& first, const io::LoadedFrame& second, const std::string& second_path) {
  bool alike = are_alike(first, second) && first.other_views.size() == second.other_views.size();
  for (std::size_t i = 0; alike && i < first.other_views.size(); ++i) {
    alike = are_alike(first.other_views[i], second.other_views[i]);
  }
  if (!alike) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: has not the size and layers of the other half of its samples", second_path));
  }
  join(first, second);
  for (std::size_t i = 0; i < first.other_views.size(); ++i)
    join(first.other_views[i], second.other_views[i]);
}

}  // namespace becalm::app
