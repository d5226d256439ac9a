// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/devices/hid/hid_bus.hpp"
#include "servo/devices/wooden/wooden_options.hpp"
#include "servo/devices/wooden/wooden_reports.hpp"

namespace spm::servo {

/// How long a V2 or V3 board may be quiet before it is sent a command without current. It only
/// answers commands, so that after a lost one both sides would wait.
inline constexpr std::chrono::milliseconds wooden_kick_after{10};

/// A WoodenHaptics board over hidraw. It is opened twice, once for each thread (HidHandle says
/// why).
class WoodenPort final : public Port<WoodenReport, WoodenCommand> {
 public:
  /// Opens the first board that the options allow and that nobody uses; one whose ids other
  /// projects' boards have too, only where the options name it. If no protocol is given, it is
  /// detected from the ids and the length of the first report, which may take 0.2 s. `connection`
  /// is put into each report. `use`: shared with the program that drives the board, for one that
  /// sends zero force in its place. Errors: file_or_device, for not found, no permission, in use,
  /// or a board whose report is not known.
  [[nodiscard]] static Result<std::unique_ptr<WoodenPort>> open(const WoodenOptions& options,
                                                                std::uint32_t connection,
                                                                const std::atomic<bool>& stop,
                                                                HidUse use = HidUse::alone);

  [[nodiscard]] Received receive(WoodenReport& report) override;
  [[nodiscard]] bool send(const WoodenCommand& command) override;

  [[nodiscard]] const HidDevice& device() const noexcept { return device_; }
  [[nodiscard]] WoodenProtocol protocol() const noexcept { return protocol_; }
  /// Before reports are received: what they tell of the board's signs.
  void set_signs(const WoodenSigns& signs, bool confirmed) noexcept {
    signs_ = signs;
    signs_confirmed_ = confirmed;
  }

 private:
  WoodenPort(HidDevice device, std::unique_ptr<HidHandle> reader, std::unique_ptr<HidHandle> writer,
             WoodenProtocol protocol, std::uint32_t connection)
      : device_(std::move(device)),
        reader_(std::move(reader)),
        writer_(std::move(writer)),
        protocol_(protocol),
        connection_(connection) {}

  HidDevice device_;
  std::unique_ptr<HidHandle> reader_, writer_;
  WoodenProtocol protocol_;
  std::uint32_t connection_;
  WoodenSigns signs_;
  bool signs_confirmed_ = false;
};

/// Whether a HID device is a board of the family that uses the protocol, or any protocol if none is
/// given. The ids of V1 and V2 are not registered, so name and usage are checked too.
[[nodiscard]] bool is_wooden_board(const HidDevice& device,
                                   std::optional<WoodenProtocol> protocol) noexcept;

}  // namespace spm::servo
