// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "common/base/device_profile.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/devices/base/port_threads.hpp"
#include "servo/devices/hid/hid_bus.hpp"
#include "servo/devices/pid/pid_options.hpp"
#include "servo/devices/pid/pid_port.hpp"

namespace spm::servo {

/// The device counts as silent if its newest report is older than this, ns: public firmware reports
/// a stick at rest each 100 ms. That one is unplugged is noticed at once, by a write that fails,
/// and effects end by themselves after pid_effect_seconds.
inline constexpr std::int64_t pid_silent_ns = 200'000'000;

/// Largest stiffness of a surface, N/m: that of the softest profile, since no source gives it for a
/// stick [U].
inline constexpr double pid_stiffness_cap = 400;
static_assert(pid_stiffness_cap == find_device_profile("touch")->stiffness_cap);

/// A joystick or another device of the HID PID class, with constant force along one or two axes.
/// These become x and y, and z stays 0. Written to USB PID 1.0 and to what the kernel's driver and
/// public firmware do; not tried on a device [U].
class DevicePid final : public Device {
 public:
  explicit DevicePid(const PidOptions& options);

  /// Errors: those of PidPort::open.
  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override;
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override;
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override;
  [[nodiscard]] DelayCounts delays() const noexcept override { return threads_.delays(); }
  void when_found_again(const std::function<void()>& tell) override {
    threads_.when_found_again(tell);
  }
  [[nodiscard]] bool wait_for_report(std::int64_t until_ns) noexcept override {
    return threads_.wait(until_ns);
  }
  [[nodiscard]] nlohmann::ordered_json describe() const override;

 private:
  [[nodiscard]] DeviceHealth health(std::int64_t at_ns) const noexcept;

  PidOptions options_;
  DeviceCapabilities capabilities_;
  PidReport report_;
  std::int64_t came_ns_ = 0;  ///< 0: none came yet
  mutable std::mutex found_mutex_;
  HidDevice found_;  ///< the one opened last; the same for its layout
  PidLayout found_layout_;
  PortThreads<PidReport, PidCommand> threads_;  ///< last: its threads use the other members
};

}  // namespace spm::servo
