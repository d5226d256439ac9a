// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>

#include <optional>

#include "common/base/error.hpp"

namespace spm::servo {

/// Holds the calling thread, and those that it starts meanwhile, to one core: the loop and the
/// threads of its devices, so that none of them wakes another across cores in a tick. The caller's
/// own thread goes where it went before when this ends.
class CorePinning {
 public:
  /// Nothing is held where no core is given. Errors: usage, there is no such core, or this process
  /// may not use it.
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
