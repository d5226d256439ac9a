// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/error.hpp"

namespace spm::baker {

/// How the baker's stages fail; caught at the edge and turned into a message and an exit code.
class BakeError : public std::runtime_error {
 public:
  BakeError(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

}  // namespace spm::baker
