// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace spm {

/// Exit codes of all programs; the numbers are part of the command-line contract.
enum class ExitCode : int {
  done = 0,
  usage = 1,
  file_or_device = 2,
  invalid_input = 3,
  internal = 4,
  unsupported = 5,
  tolerance_not_met = 10,
  batch_failed = 11,
  realtime_refused = 12,
};

/// An error: one sentence that names file, place, cause and remedy, and the exit code for it.
struct Error {
  ExitCode code = ExitCode::internal;
  std::string message;
};

/// A value, or the error that explains why there is none. Used while loading; never by a query.
template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ExitCode code, std::string message) {
  return tl::make_unexpected(Error{code, std::move(message)});
}

}  // namespace spm
