// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <utility>
#include <vector>

#include "servo/devices/base/device.hpp"

namespace spm::test {

/// A device whose answers a test writes, and which keeps every wrench that it was sent.
class ScriptedDevice final : public servo::Device {
 public:
  /// What the device says in its nth read; `health` is ok unless set.
  using Script =
      std::function<void(std::size_t read, servo::DeviceState& state, servo::DeviceHealth& health)>;

  explicit ScriptedDevice(Script script, double force_cap = 10);

  /// Makes the loop stop in tick number `ticks`, which is 2 or more. Only ticks that are run count,
  /// since the number that a slow machine skips does not matter to the test.
  void end_after(std::size_t ticks, std::atomic<bool>& stop) {
    last_read_ = ticks - 2;
    stop_ = &stop;
  }

  [[nodiscard]] Result<void> open(const servo::DeviceSetup&) override { return {}; }
  [[nodiscard]] const servo::DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] servo::DeviceHealth read(servo::DeviceState& state) noexcept override;
  [[nodiscard]] servo::DeviceHealth write(const servo::Wrench& wrench) noexcept override;
  [[nodiscard]] nlohmann::ordered_json describe() const override;

  [[nodiscard]] servo::DelayCounts delays() const noexcept override {
    return delays_ ? delays_(reads_) : servo::DelayCounts{};
  }
  /// Sets what the device tells of its delays, by the number of its reads.
  void tell_delays(std::function<servo::DelayCounts(std::size_t read)> delays) {
    delays_ = std::move(delays);
  }

  /// What the device can do. Change it only before a loop uses the device.
  [[nodiscard]] servo::DeviceCapabilities& can() { return capabilities_; }
  /// Makes each report come `period_ns` after the last, ns. Without this it cannot pace a loop.
  void report_every(std::int64_t period_ns) { period_ns_ = period_ns; }
  [[nodiscard]] bool wait_for_report(std::int64_t until_ns) noexcept override;

  [[nodiscard]] const std::vector<Vector3>& forces() const { return forces_; }
  [[nodiscard]] const std::vector<Vector3>& torques() const { return torques_; }

 private:
  Script script_;
  std::function<servo::DelayCounts(std::size_t)> delays_;
  servo::DeviceCapabilities capabilities_;
  std::int64_t period_ns_ = 0, reported_ns_ = 0;
  std::size_t reads_ = 0, last_read_ = 0;
  std::atomic<bool>* stop_ = nullptr;
  std::vector<Vector3> forces_, torques_;
};

}  // namespace spm::test
