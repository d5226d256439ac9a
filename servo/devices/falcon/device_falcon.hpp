// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/devices/base/port_threads.hpp"
#include "servo/devices/falcon/falcon_firmware.hpp"
#include "servo/devices/falcon/falcon_options.hpp"
#include "servo/devices/falcon/falcon_packet.hpp"
#include "servo/devices/falcon/falcon_tracker.hpp"

namespace spm::servo {

/// A Novint Falcon on a USB port. It gives no force before it is homed: pull its grip all the way
/// out once, and push it in. Its lights are red until then, green while it is used, and blue if
/// there is no force because its reports make no sense or do not come. Unverified, since no real
/// Falcon was at hand: homing, forces, the timing of its firmware, and what it does by itself when
/// it receives no packet.
class DeviceFalcon final : public Device {
 public:
  using Threads = PortThreads<FalconReport, FalconCommand>;

  explicit DeviceFalcon(FalconOptions options);

  /// Finds the device, and loads its firmware if none runs, which takes some seconds. Errors: those
  /// of the firmware file, of USB, and of the upload.
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
  /// What the last opening found. Written by the thread that opens.
  struct Connection {
    std::string path;
    bool uploaded = false;      ///< whether it was given its firmware
    std::uint32_t uploads = 0;  ///< since the start
  };

  [[nodiscard]] Result<std::unique_ptr<Threads::DevicePort>> connect(const std::atomic<bool>& stop);
  [[nodiscard]] DeviceHealth look() noexcept;
  /// Motor commands for a force, N. False if there are none.
  [[nodiscard]] bool push(const Vector3& force, FalconCommand& command) noexcept;

  FalconOptions options_;
  DeviceCapabilities capabilities_;
  std::optional<FalconFirmwareFile> firmware_;

  mutable std::mutex mutex_;  ///< guards the connection; read and write never take it
  Connection connection_;

  // Used by the loop alone, except the atomic.
  FalconTracker tracker_;
  DeviceHealth health_ = DeviceHealth::silent;
  DeviceHealth followed_ = DeviceHealth::silent;  ///< the result of the newest report
  std::uint32_t buttons_ = 0;
  std::int64_t came_ns_ = 0;
  std::atomic<bool> homed_{false};

  Threads threads_;  ///< last, so that its threads end before the members that they use
};

}  // namespace spm::servo
