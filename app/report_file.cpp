#include "app/report_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <system_error>

#include "app/outputs.h"
#include "app/partial_files.h"
#include "frame/error.h"
#include "frame/io/atomic_file.h"
#include "frame/pictures/pictures.h"
#include "frame/text_file.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

bool has_members(const std::string& text, std::initializer_list<const char*> keys) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  return json.is_object() && std::ranges::all_of(keys, [&](const char* key) { return json.contains(key); });
}

bool is_report(ReportKind kind, const std::string& text) {
  switch (kind) {
    case ReportKind::test_junit:
      return text.find("<testsuites name=\"becalm test\"") != std::string::npos;
    case ReportKind::test_json:
      return has_members(text, {"seconds", "passed", "failed", "error", "skipped", "cases"});
    case ReportKind::test_page:
      return text.find("<title>becalm: regression tests</title>") != std::string::npos;
    case ReportKind::compare_json:
      return has_members(text, {"reference", "test", "frames", "mean", "failures"});
    case ReportKind::compare_page:
      return text.find("<title>becalm compare</title>") != std::string::npos;
    case ReportKind::compare_picture:
      return text.starts_with("\x89PNG") && text.find(pictures::kPngMark) != std::string::npos;
  }
  return false;
}

constexpr const char* description_of(ReportKind kind) {
  switch (kind) {
    case ReportKind::test_junit:
      return "JUnit report of becalm test";
    case ReportKind::test_json:
      return "JSON report of becalm test";
    case ReportKind::test_page:
      return "page of becalm test";
    case ReportKind::compare_json:
      return "JSON report of becalm compare";
    case ReportKind::compare_page:
      return "page of becalm compare";
    case ReportKind::compare_picture:
      return "picture of becalm compare";
  }
  return "";
}

[[noreturn]] void fail(ExitStatus status, const ReportFile& report, const std::string& message) {
  throw Error(status, fmt::format("{} {}: {}", report.option, report.path, message));
}

constexpr std::string_view kDash = "-";

/// Also where that is a file: it holds what was said before.
bool is_standard_output(const std::string& path) {
  std::error_code error;
  return path == kDash || path == "/dev/stdout" || fs::equivalent(path, "/dev/stdout", error);
}

/// Standard output or error, another device or a pipe.
bool is_stream(const std::string& path) {
  std::error_code ignored;
  return is_standard_output(path) || path == "/dev/stderr" || fs::is_other(path, ignored);
}

/// What is_report looks at: of a picture its beginning, since there may be thousands of them. Nothing where
/// the file cannot be read, or is larger than any report.
std::optional<std::string> text_of(const ReportFile& report) {
  constexpr std::uintmax_t largest_report = 1u << 28;
  constexpr std::size_t picture_header = 4096;
  std::error_code error;
  if (report.kind != ReportKind::compare_picture) {
    if (fs::file_size(report.path, error) > largest_report) return std::nullopt;
    return read_text_file(report.path);
  }
  std::ifstream file(report.path, std::ios::binary);
  std::string text(picture_header, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return std::nullopt;
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

bool is_earlier_report(const ReportFile& report) {
  const std::optional<std::string> text = text_of(report);
  return text && is_report(report.kind, *text);
}

void keep_foreign_file(const ReportFile& report) {
  std::error_code error;
  if (!fs::is_regular_file(report.path, error) || fs::file_size(report.path, error) == 0) return;
  if (is_earlier_report(report)) return;
  fail(ExitStatus::usage, report,
       fmt::format("is there, and is no {}; choose another name", description_of(report.kind)));
}

/// Puts the text in place of the report's file, which is the one behind links. Without a text only tries
/// whether the file can be made: to root, access(2) allows everything.
void write_file(const ReportFile& report, const std::optional<std::string_view>& text) {
  try {
    io::AtomicFile file(resolved(report.path));
    if (!text) return;
    file.write(text->data(), text->size());
    file.commit();
  } catch (const Error& error) {
    throw Error(error.status(), fmt::format("{} {}", report.option, error.what()));
  }
}

void write_stream(const ReportFile& report, std::string_view text) {
  if (is_standard_output(report.path)) {
    fmt::print("{}", text);
    return;
  }
  std::ofstream file(report.path);
  if (!(file << text) || !file.flush()) fail(ExitStatus::resource, report, "cannot write it");
}

void check_place_of(const ReportFile& report) {
  if (!is_stream(report.path)) {
    write_file(report, std::nullopt);
  } else if (!is_standard_output(report.path) && ::access(report.path.c_str(), W_OK) != 0) {
    fail(ExitStatus::resource, report, "cannot write it");
  }
}

}  // namespace

std::FILE* stream_beside(const std::vector<ReportFile>& reports) {
  const bool taken = std::ranges::find(reports, kDash, &ReportFile::path) != reports.end();
  return taken ? stderr : stdout;
}

ReportFile file_in(const std::string& folder, const std::string& name, ReportKind kind) {
  return {"--report", (fs::path(folder) / name).string(), kind};
}

ReportFile page_in(const std::string& folder, ReportKind kind) {
  return file_in(folder, "index.html", kind);
}

void empty_earlier(const std::vector<ReportFile>& reports) {
  for (const ReportFile& report : reports) {
    std::error_code error;
    const bool is_file = !is_stream(report.path) && fs::is_regular_file(report.path, error);
    if (is_file && is_earlier_report(report)) write_file(report, "");
  }
}

void check_report_files(const std::vector<ReportFile>& reports, const std::vector<std::string>& inputs) {
  std::set<std::string> read;
  for (const std::string& input : inputs) read.insert(resolved(input));
  std::set<std::string> written;
  for (const ReportFile& report : reports) {
    const bool is_dash = report.path == kDash;
    if (is_stream(report.path) && !is_dash) continue;
    const std::string place = is_dash ? report.path : resolved(report.path);
    if (read.contains(place))
      fail(ExitStatus::usage, report, "would overwrite the input; choose another name");
    if (!written.insert(place).second)
      fail(ExitStatus::usage, report, "is another report's, too; choose another name");
    if (!is_dash) keep_foreign_file(report);
  }
  for (const ReportFile& report : reports) check_place_of(report);
  written.erase(std::string(kDash));
  remove_abandoned_partials({written.begin(), written.end()});
}

void write_report_file(const ReportFile& report, std::string_view text) {
  if (is_stream(report.path)) {
    write_stream(report, text);
    return;
  }
  keep_foreign_file(report);
  write_file(report, text);
}

void write_report_files(const std::vector<ReportFile>& reports,
                        const std::function<std::string(ReportKind)>& text_of) {
  std::exception_ptr first;
  for (const ReportFile& report : reports) {
    try {
      write_report_file(report, text_of(report.kind));
    } catch (const Error&) {
      if (!first) first = std::current_exception();
    }
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace becalm::app
