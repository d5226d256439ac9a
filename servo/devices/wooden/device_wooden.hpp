// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/port_threads.hpp"
#include "servo/devices/hid/hid_bus.hpp"
#include "servo/devices/wooden/wooden_options.hpp"
#include "servo/devices/wooden/wooden_port.hpp"
#include "servo/devices/wooden/wooden_tracker.hpp"

namespace spm::servo {

/// A WoodenHaptics or another arm of its family over HID (V1, V2, V3): three motors, and a handle
/// whose orientation some models measure. There is no force before its user has confirmed its
/// signs. Written to the protocols that public hosts show; not tried on a device [U].
class DeviceWooden final : public Device {
 public:
  using Threads = PortThreads<WoodenReport, WoodenCommand>;

  explicit DeviceWooden(const WoodenOptions& options);

  /// Errors: those of WoodenPort::open; file_or_device, signs that cannot be kept.
  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override;
  /// The same as `open`, with connections that the caller makes. Errors: theirs.
  [[nodiscard]] Result<void> start(Threads::Open open, RealtimeMode realtime);
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override;
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override;
  [[nodiscard]] bool wait_for_report(std::int64_t until_ns) noexcept override;
  [[nodiscard]] DelayCounts delays() const noexcept override { return threads_.delays(); }
  void when_found_again(const std::function<void()>& tell) override {
    threads_.when_found_again(tell);
  }
  [[nodiscard]] nlohmann::ordered_json describe() const override;

 private:
  [[nodiscard]] DeviceHealth health(std::int64_t at_ns) const noexcept;
  /// Tells a port that was just opened the signs of its board, and the user what is to be done.
  /// Errors: those of keep_signs.
  [[nodiscard]] Result<void> know_signs(WoodenPort& port);

  WoodenOptions options_;
  DeviceCapabilities capabilities_;
  WoodenTracker tracker_;
  std::uint32_t connections_ = 0;  ///< counted by the thread that opens
  mutable std::mutex found_mutex_;
  HidDevice found_;  ///< the one opened last; the same for its protocol
  WoodenProtocol found_protocol_ = WoodenProtocol::v1;
  WoodenSigns found_signs_;
  bool found_confirmed_ = false;
  Threads threads_;  ///< last: its threads use the other members
};

}  // namespace spm::servo
