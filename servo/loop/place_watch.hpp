// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "servo/devices/base/device.hpp"
#include "servo/loop/supervisor.hpp"

namespace spm::servo {

/// Names all devices, where they are plugged in now, to a supervisor. Errors: those of
/// Supervisor::watch.
[[nodiscard]] Result<void> name_devices(Supervisor& supervisor,
                                        const std::vector<Device*>& devices);

/// Names them again when one was found again, perhaps at another place, before it is driven there.
class PlaceWatch {
 public:
  /// `supervisor` may be null. It and the devices outlive this.
  PlaceWatch(Supervisor* supervisor, const std::vector<Device*>& devices);
  PlaceWatch(const PlaceWatch&) = delete;
  PlaceWatch& operator=(const PlaceWatch&) = delete;
  ~PlaceWatch();

  /// Why the devices could not be named; told once, and from then on they are not named any more.
  /// Empty: they could, or it was told.
  [[nodiscard]] std::string take_fault();

 private:
  void name();

  std::mutex mutex_;  ///< two devices may be found at once
  Supervisor* supervisor_;
  const std::vector<Device*>& devices_;
  std::string fault_;
};

}  // namespace spm::servo
