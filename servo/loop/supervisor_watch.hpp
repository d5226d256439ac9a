// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "servo/loop/supervisor.hpp"

namespace spm::servo {

/// Notices that the supervisor has ended, and starts it again. A thread of its own, which sleeps
/// until then.
class SupervisorWatch {
 public:
  using Log = std::function<void(const std::string&)>;

  /// `supervisor` may be null, and else outlives this.
  SupervisorWatch(Supervisor* supervisor, Log warn);
  SupervisorWatch(const SupervisorWatch&) = delete;
  SupervisorWatch& operator=(const SupervisorWatch&) = delete;
  ~SupervisorWatch();

 private:
  void look(Supervisor& supervisor) const;

  Log warn_;
  int stop_ = -1;
  std::thread thread_;
};

}  // namespace spm::servo
