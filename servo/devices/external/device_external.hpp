// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "servo/devices/base/device.hpp"
#include "servo/devices/base/latency_histogram.hpp"
#include "servo/devices/external/external_options.hpp"

struct spm_external_memory;

namespace spm::servo {

/// A device that another process drives. That process supplies poses and takes wrenches over shared
/// memory (spm_external.h). The memory cannot be shrunk, and nothing that is written into it can do
/// more than take the force away: numbers that are not finite and orientations that are not unit
/// are faults, and poses whose counter no longer changes are silence.
class DeviceExternal final : public Device {
 public:
  explicit DeviceExternal(const ExternalOptions& options);
  ~DeviceExternal() override;

  /// Makes the memory, and the link by which it is found. Errors: file_or_device, if another daemon
  /// has the name, or there is no memory.
  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override;
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override;
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override;
  [[nodiscard]] DelayCounts delays() const noexcept override { return delays_; }
  [[nodiscard]] nlohmann::ordered_json describe() const override;

 private:
  [[nodiscard]] Result<void> make_link();

  ExternalOptions options_;
  DeviceCapabilities capabilities_;
  std::string link_;
  int descriptor_ = -1;
  spm_external_memory* memory_ = nullptr;
  DeviceState last_;
  std::uint64_t last_counter_ = 0;
  std::int64_t last_ns_ = 0;  ///< when the loop took it
  std::int64_t put_ns_ = 0;   ///< when its process wrote it
  bool attached_ = false;     ///< whether a process has supplied a pose
  bool fresh_ = false;        ///< no wrench has answered the last pose
  DelayCounts delays_;
  LatencyHistogram report_age_;         ///< from when a pose was written to when the loop took it
  LatencyHistogram report_to_command_;  ///< from when a pose was written to its wrench
};

}  // namespace spm::servo
