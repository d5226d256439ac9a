// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <nlohmann/json.hpp>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/port_threads.hpp"
#include "servo/devices/hid/hid_bus.hpp"
#include "servo/devices/spacemouse/spacemouse_motion.hpp"
#include "servo/devices/spacemouse/spacemouse_options.hpp"
#include "servo/devices/spacemouse/spacemouse_port.hpp"

namespace spm::servo {

/// Longest time for which a late tick moves the tool, s.
inline constexpr double spacemouse_longest_step = 0.02;

/// A 3Dconnexion SpaceMouse. It moves and rotates a tool, and gives no force. Silence means that
/// nothing changed, so only unplugging it is a loss; the tool then stays where it is. Not tried on
/// a device [U].
class DeviceSpaceMouse final : public Device {
 public:
  explicit DeviceSpaceMouse(const SpaceMouseOptions& options);
  ~DeviceSpaceMouse() override;

  /// Errors: those of SpaceMousePort::open.
  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override;
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override;
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override;
  [[nodiscard]] nlohmann::ordered_json describe() const override;

 private:
  [[nodiscard]] DeviceHealth health() const noexcept;

  SpaceMouseOptions options_;
  DeviceCapabilities capabilities_;
  SpaceMouseMotion motion_;
  SpaceMouseState mouse_;
  std::int64_t read_ns_ = 0;
  std::atomic<int> battery_percent_{-1};
  mutable std::mutex found_mutex_;
  HidDevice found_;  ///< the last one opened
  /// last: its threads use the other members
  PortThreads<SpaceMouseState, SpaceMouseCommand> threads_;
};

}  // namespace spm::servo
