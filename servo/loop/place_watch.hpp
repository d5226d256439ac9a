// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "servo/devices/base/device.hpp"
#include "servo/loop/supervisor.hpp"

namespace spm::servo {

/// Names all devices, where they are plugged in now, to a supervisor. Errors: those of
/// Supervisor::watch.
[[nodiscard]] Result<void> name_devices(Supervisor& supervisor,
                                        const std::vector<Device*>& devices);

/// Names them again when one was found again, perhaps at another place.
class PlaceWatch {
 public:
  /// `supervisor` may be null. `warn`: called with a sentence where one cannot be named.
  PlaceWatch(Supervisor* supervisor, const std::vector<Device*>& devices,
             std::function<void(const std::string&)> warn)
      : supervisor_(supervisor), devices_(devices), warn_(std::move(warn)) {}

  void look();

 private:
  Supervisor* supervisor_;
  const std::vector<Device*>& devices_;
  std::function<void(const std::string&)> warn_;
  std::uint64_t reopened_ = 0;
};

}  // namespace spm::servo
