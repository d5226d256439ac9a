// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

}  // namespace spm::baker
