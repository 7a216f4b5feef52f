#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace becalm::bench {

/// The main function of a program that reads JSON commands from standard input, one a line, and answers each
/// with a line of JSON: the result of `Service::answer`, or {"error": MESSAGE} if that throws, after which
/// the next command is read. `arguments` are those of the service's constructor. Returns the program's exit
/// status.
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
