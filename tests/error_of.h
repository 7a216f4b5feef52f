#pragma once

#include <gtest/gtest.h>

#include <string>

#include "frame/error.h"

namespace becalm {

/// The message, of one line, of the Error of that status in which `work` ends; "no error" if it does not.
template <class Work>
std::string error_of(ExitStatus status, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), status) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
    return error.what();
  }
  return "no error";
}

}  // namespace becalm
