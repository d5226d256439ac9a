// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>

#include <optional>

#include "common/base/error.hpp"

namespace spm::servo {

/// Holds the calling thread, and the threads that it starts meanwhile, to one core. The loop and
/// the threads of its devices use it, so that none of them wakes another across cores in a tick.
/// When this ends, the calling thread may use the same cores as before.
class CorePinning {
 public:
  /// Holds nothing if no core is given. Errors: usage, if there is no such core or this process may
  /// not use it.
  [[nodiscard]] static Result<CorePinning> hold(std::optional<unsigned> core);

  CorePinning(CorePinning&& other) noexcept;
  CorePinning& operator=(CorePinning&&) = delete;
  CorePinning(const CorePinning&) = delete;
  CorePinning& operator=(const CorePinning&) = delete;
  ~CorePinning();

 private:
  CorePinning() = default;

  std::optional<cpu_set_t> before_;
};

}  // namespace spm::servo
