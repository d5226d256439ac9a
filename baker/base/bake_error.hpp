// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/error.hpp"

namespace spm::baker {

/// How a stage of the baker fails. main.cpp catches it and turns it into a message and an exit
/// code.
class BakeError : public std::runtime_error {
 public:
  BakeError(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

/// What to say of an exception that left a command; `saving` tells how to need less memory.
[[nodiscard]] inline Error error_of(const std::exception& problem, const std::string& saving) {
  if (const auto* known = dynamic_cast<const BakeError*>(&problem)) {
    return {known->code(), known->what()};
  }
  if (dynamic_cast<const std::bad_alloc*>(&problem) != nullptr) {
    return {ExitCode::internal, "out of memory; " + saving};
  }
  return {ExitCode::internal, problem.what()};
}

}  // namespace spm::baker
