// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "servo/devices/hid/hid_bus.hpp"
#include "servo/devices/pid/pid_codec.hpp"
#include "servo/devices/pid/pid_layout.hpp"
#include "servo/devices/pid/pid_options.hpp"
#include "servo/devices/base/port.hpp"

namespace spm::servo {

/// A stick that did not move may tell nothing, so that one that is quiet for so long is asked: as
/// long as a low-speed device may be left between two reports.
inline constexpr std::chrono::milliseconds pid_ask_after{10};

/// The watchdog: effects end after the first of these unless they are started again, which happens
/// in every second. That devices keep to a duration, and go on without a gap where an effect is
/// started again, is what public firmware does; other firmware is unverified [U].
inline constexpr double pid_effect_seconds = 0.2;
inline constexpr std::chrono::milliseconds pid_restart_after{50};

/// A force feedback device of the HID PID class over hidraw, opened twice, once for each thread
/// (HidHandle says why). The kernel's own driver of that class stays at it, and sends nothing
/// unless a program asks it to.
class PidPort final : public Port<PidReport, PidCommand> {
 public:
  /// Opens the first that the options allow and that nobody uses, resets it, and starts an effect
  /// of constant force, 0, for each axis. Errors: file_or_device, not found, no permission, in use,
  /// or an effect that it refuses; unsupported, a descriptor that lacks something, which is named.
  [[nodiscard]] static Result<std::unique_ptr<PidPort>> open(const PidOptions& options,
                                                             const std::atomic<bool>& stop);

  /// Stops its effects and gives their memory back.
  ~PidPort() override;

  /// Gives all that the device told since it was opened, not the last report alone.
  [[nodiscard]] Received receive(PidReport& report) override;
  [[nodiscard]] bool send(const PidCommand& command) override;

  [[nodiscard]] const HidDevice& device() const noexcept { return device_; }
  [[nodiscard]] const PidLayout& layout() const noexcept { return layout_; }

 private:
  PidPort(HidDevice device, PidLayout layout, std::unique_ptr<HidHandle> reader,
          std::unique_ptr<HidHandle> writer, bool watchdog)
      : device_(std::move(device)),
        layout_(std::move(layout)),
        reader_(std::move(reader)),
        writer_(std::move(writer)),
        watchdog_(watchdog) {}

  [[nodiscard]] Result<void> set_up(const std::atomic<bool>& stop);
  [[nodiscard]] Result<void> check_memory();
  [[nodiscard]] Result<PidBlock> create_effect(const std::atomic<bool>& stop);
  [[nodiscard]] tl::unexpected<Error> failed(const char* what) const;
  [[nodiscard]] bool send_message(const PidMessage& message);
  [[nodiscard]] bool take(std::span<const std::uint8_t> bytes, PidReport& report);
  [[nodiscard]] Received ask(PidReport& report);

  HidDevice device_;
  PidLayout layout_;
  std::unique_ptr<HidHandle> reader_, writer_;
  bool watchdog_;
  PidReport told_;
  int unanswered_ = 0;  ///< questions for a report
  std::vector<PidBlock> effects_;
  std::array<double, 2> sent_{};
  std::int64_t started_ns_ = 0;
};

/// The report descriptor of a hidraw node, from /sys, where anybody may read it; empty where it is
/// not there.
[[nodiscard]] std::vector<std::uint8_t> hid_descriptor_of(const HidDevice& device);

}  // namespace spm::servo
