// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "servo/devices/finder/zero_force.hpp"

namespace spm::servo {

/// Opens a device of a target for zero force.
using OpenZeroForce = std::function<Result<ZeroForce>(const std::string& target)>;

/// The devices that a supervisor looks after, and what it does to them once the daemon no longer
/// drives them.
class LeftDevices {
 public:
  using Clock = std::chrono::steady_clock;

  explicit LeftDevices(const OpenZeroForce& open) : open_(open) {}

  /// Takes over a list of targets. Those that may be opened early are opened now, so that their
  /// first zero needs no search.
  void watch(const std::vector<std::string>& targets);
  [[nodiscard]] bool empty() const noexcept { return devices_.empty(); }

  /// Begins to send zero: some to each device. Devices that cannot be opened are looked for until
  /// `due`.
  void begin(Clock::time_point due);
  /// Sends one zero to each device that still needs one. False if no device does any longer. All
  /// are held open until the last one is done, so that none is found twice.
  [[nodiscard]] bool send_zeros();
  /// The daemon drives the devices again: closes those that were not opened early.
  void let_go();

  /// What became of the devices: "zero force was sent to ...".
  [[nodiscard]] std::string outcome() const;

 private:
  struct LeftDevice {
    std::string target;
    ZeroForce send;       ///< empty until the device is open
    int left = 0;         ///< zeros still to be sent
    std::string problem;  ///< why the device is not open
  };

  [[nodiscard]] bool serve(LeftDevice& device) const;

  OpenZeroForce open_;
  std::vector<LeftDevice> devices_;
  Clock::time_point due_;
};

}  // namespace spm::servo
