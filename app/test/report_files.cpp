#include "app/test/report_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/json_number.h"

namespace becalm::app {
namespace {

/// Text of an XML 1.0 document, which cannot hold control characters. Bytes that are no UTF-8 become `?`.
std::string xml_text(const std::string& text) {
  // The JSON writer replaces what is no UTF-8.
  const std::string valid = nlohmann::json::parse(
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  std::string escaped;
  for (const char c : valid) {
    const bool control = static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t';
    escaped += c == '<'   ? "&lt;"
               : c == '>' ? "&gt;"
               : c == '&' ? "&amp;"
               : c == '"' ? "&quot;"
               : control  ? "?"
                          : std::string(1, c);
  }
  return escaped;
}

std::string counts(const TestResults& results) {
  return fmt::format(R"(tests="{}" failures="{}" errors="{}" skipped="{}")", results.cases.size(),
                     count_of(results, CaseOutcome::failed), count_of(results, CaseOutcome::error),
                     count_of(results, CaseOutcome::skipped));
}

std::string test_case_xml(const CaseResult& result) {
  std::string xml = fmt::format(R"(    <testcase classname="{}" name="{}" time="{:.3f}")",
                                xml_text(result.suite), xml_text(result.name), result.seconds);
  const std::string output = result.outcome == CaseOutcome::passed ? "" : result.output;
  if (result.outcome == CaseOutcome::passed) return xml + "/>\n";
  const std::string message = result.messages.empty() ? "" : result.messages.front();
  xml += ">\n";
  if (result.outcome == CaseOutcome::skipped) {
    xml += fmt::format("      <skipped message=\"{}\"/>\n", xml_text(message));
  } else {
    const char* element = result.outcome == CaseOutcome::failed ? "failure" : "error";
    std::string body = fmt::format("{}\n", fmt::join(result.messages, "\n"));
    if (!result.command.empty()) body += "command: " + result.command + "\n";
    xml += fmt::format("      <{0} message=\"{1}\" type=\"{0}\">{2}</{0}>\n", element, xml_text(message),
                       xml_text(body));
  }
  if (!output.empty()) xml += fmt::format("      <system-out>{}</system-out>\n", xml_text(output));
  return xml + "    </testcase>\n";
}

/// The results of each suite file, in their order.
std::vector<TestResults> by_suite(const TestResults& results) {
  std::vector<TestResults> suites;
  std::map<std::string, std::size_t> places;
  for (const CaseResult& result : results.cases) {
    const auto [place, is_new] = places.try_emplace(result.suite_file, suites.size());
    if (is_new) suites.emplace_back();
    suites[place->second].cases.push_back(result);
    suites[place->second].seconds += result.seconds;
  }
  return suites;
}

nlohmann::ordered_json to_json(const CheckResult& check) {
  nlohmann::ordered_json json{{"judge", check.judge},
                              {"figure", check.figure},
                              {"frame", nullptr},
                              {"value", json_number(check.value)},
                              {"limit", json_number(check.limit)},
                              {"passed", check.passed},
                              {"text", check.text}};
  if (check.frame) json["frame"] = *check.frame;
  return json;
}

nlohmann::ordered_json to_json(const CaseResult& result) {
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();
  for (const CheckResult& check : result.checks) checks.push_back(to_json(check));
  return {{"suite", result.suite},       {"suite_file", result.suite_file},
          {"name", result.name},         {"outcome", name_of(result.outcome)},
          {"messages", result.messages}, {"checks", std::move(checks)},
          {"command", result.command},   {"output", result.output},
          {"seconds", result.seconds},   {"peak_memory_bytes", result.peak_memory_bytes}};
}

}  // namespace

std::string junit_xml(const TestResults& results) {
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  xml +=
      fmt::format("<testsuites name=\"becalm test\" {} time=\"{:.3f}\">\n", counts(results), results.seconds);
  for (const TestResults& suite : by_suite(results)) {
    xml += fmt::format("  <testsuite name=\"{}\" {} time=\"{:.3f}\">\n", xml_text(suite.cases.front().suite),
                       counts(suite), suite.seconds);
    for (const CaseResult& result : suite.cases) xml += test_case_xml(result);
    xml += "  </testsuite>\n";
  }
  return xml + "</testsuites>\n";
}

std::string results_json(const TestResults& results) {
  nlohmann::ordered_json json{{"seconds", results.seconds}};
  for (const CaseOutcome outcome :
       {CaseOutcome::passed, CaseOutcome::failed, CaseOutcome::error, CaseOutcome::skipped}) {
    json[name_of(outcome)] = count_of(results, outcome);
  }
  json["cases"] = nlohmann::ordered_json::array();
  for (const CaseResult& result : results.cases) json["cases"].push_back(to_json(result));
  return json.dump(2, ' ', /*ensure_ascii=*/false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace becalm::app
