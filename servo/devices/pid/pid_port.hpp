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
#include "servo/devices/base/port.hpp"
#include "servo/devices/hid/hid_bus.hpp"
#include "servo/devices/pid/pid_codec.hpp"
#include "servo/devices/pid/pid_layout.hpp"
#include "servo/devices/pid/pid_options.hpp"

namespace spm::servo {

/// A stick that does not move may send nothing, so one that is quiet for this long is asked. It is
/// the longest polling interval of a low-speed device.
inline constexpr std::chrono::milliseconds pid_ask_after{10};

/// The watchdog: effects end after the first of these times unless they are started again, which
/// happens after every second one. That devices respect a duration, and go on without a gap when an
/// effect is started again, is what public firmware does; other firmware is unverified [U].
inline constexpr double pid_effect_seconds = 0.2;
inline constexpr std::chrono::milliseconds pid_restart_after{50};

/// A force feedback device of the HID PID class over hidraw. It is opened twice, once for each
/// thread (HidHandle says why). The kernel's own driver of that class stays bound to it, and sends
/// nothing unless a program asks it to.
class PidPort final : public Port<PidReport, PidCommand> {
 public:
  /// Opens the first device that the options allow and that nobody uses (with `use` shared: nobody
  /// but the program whose force it ends), resets it, and starts an
  /// effect of constant force, 0, for each axis. Errors: file_or_device, for not found, no
  /// permission, in use, or an effect that the device refuses; unsupported, for a descriptor that
  /// lacks something, which is named.
  [[nodiscard]] static Result<std::unique_ptr<PidPort>> open(const PidOptions& options,
                                                             const std::atomic<bool>& stop,
                                                             HidUse use = HidUse::alone);

  /// Stops its effects and frees their memory.
  ~PidPort() override;

  /// Returns everything that the device has reported since it was opened, not only the last report.
  [[nodiscard]] Received receive(PidReport& report) override;
  [[nodiscard]] bool send(const PidCommand& command) override;

  [[nodiscard]] const HidDevice& device() const noexcept { return device_; }
  [[nodiscard]] const PidLayout& layout() const noexcept { return layout_; }

 private:
  PidPort(HidDevice device, PidLayout layout, std::unique_ptr<HidHandle> reader,
          std::unique_ptr<HidHandle> writer, bool watchdog, HidUse use)
      : device_(std::move(device)),
        layout_(std::move(layout)),
        reader_(std::move(reader)),
        writer_(std::move(writer)),
        watchdog_(watchdog),
        use_(use) {}

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
  HidUse use_;
  PidReport latest_;
  int unanswered_ = 0;  ///< requests for a report without an answer
  std::vector<PidBlock> effects_;
  std::array<double, 2> sent_{};
  std::int64_t started_ns_ = 0;
  std::int64_t last_send_ns_ = 0;  ///< 0: nothing was sent yet
};

/// The report descriptor of a hidraw node, from /sys, where anybody may read it. Empty if it is not
/// there.
[[nodiscard]] std::vector<std::uint8_t> hid_descriptor_of(const HidDevice& device);

}  // namespace spm::servo
