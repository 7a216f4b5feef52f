#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace becalm::bench {

/// The main function of a program that answers each line of standard input, a JSON command, by a line of
/// JSON: what `Service::answer` returns, or {"error": MESSAGE} if that throws; the next command is read all
/// the same. `arguments` are those of the service's constructor. Returns the program's exit status.
template <class Service, class... Arguments>
int serve(const char* program, Arguments&&... arguments) {
  try {
    Service service(std::forward<Arguments>(arguments)...);
    for (std::string line; std::getline(std::cin, line);) {
      nlohmann::json answer;
      try {
        answer = service.answer(nlohmann::json::parse(line));
      } catch (const std::exception& error) {
        answer = {{"error", error.what()}};
      }
      fmt::print("{}\n", answer.dump());
      std::fflush(stdout);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 4;
  }
}

}  // namespace becalm::bench
