#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::app {

/// The kinds of reports. A report replaces an existing file only if that is empty or a report of its kind.
enum class ReportKind { test_junit, test_json, test_page, compare_json, compare_page, compare_picture };

/// A report that an option asked for. `-`, `/dev/stdout` and other names of the file behind it are standard
/// output; other devices and pipes are written to.
struct ReportFile {
  std::string option;
  std::string path;
  ReportKind kind;
};

/// The stream for a command's own lines: standard error if the path of a report is `-`, since a program may
/// read that report from standard output; else standard output.
std::FILE* stream_beside(const std::vector<ReportFile>& reports);

/// A file of --report.
ReportFile file_in(const std::string& folder, const std::string& name, ReportKind kind);
/// The page of --report: `folder`/index.html.
ReportFile page_in(const std::string& folder, ReportKind kind);

/// At the very start: puts empty files in place of the reports of an earlier run, which would be taken for
/// this one's if it fails before it has results. What is no report of that kind stays.
void empty_earlier(const std::vector<ReportFile>& reports);

/// Before the work whose results the reports tell. Throws Error(usage) where a report is one of the inputs or
/// another report, or where there is a file that is neither empty nor a report of that kind, and
/// Error(resource) where no file can be made. Makes the reports' folders, and removes what killed runs left
/// half-written of them.
void check_report_files(const std::vector<ReportFile>& reports, const std::vector<std::string>& inputs = {});

/// A regular file appears or is replaced whole (io::AtomicFile), and its folder is made. Throws
/// Error(resource) naming the option, or Error(usage) as check_report_files.
void write_report_file(const ReportFile& report, std::string_view text);

/// Writes all of them, each with its text. Throws the first Error after all were tried.
void write_report_files(const std::vector<ReportFile>& reports,
                        const std::function<std::string(ReportKind)>& text_of);

}  // namespace becalm::app
