// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// The HID protocols of the WoodenHaptics family, as its public hosts and firmware speak them:
/// V1 free-running, V2 and V3 one report for one command. None was tried on a device here [U].
enum class WoodenProtocol : std::uint8_t { v1, v2, v3 };

[[nodiscard]] const char* to_string(WoodenProtocol protocol) noexcept;

/// What the board tells.
struct WoodenReport {
  std::array<std::int16_t, 6> counters{};  ///< encoders A to F as they count; D to F not in V1
  std::uint16_t sequence = 0;              ///< V1: one more each report; else 0
  bool calibration_pressed = false;        ///< V2 and V3: stays until the counters are set
  WoodenProtocol protocol = WoodenProtocol::v1;
  std::uint32_t connection = 0;  ///< one more each time that the board was opened
};

enum class WoodenRequest : std::uint8_t {
  currents,      ///< currents for the motors
  set_counters,  ///< V2 and V3: new counts for all encoders; the motors get none for one cycle
};

/// What the board is told.
struct WoodenCommand {
  WoodenRequest request = WoodenRequest::currents;
  std::array<std::int16_t, 3> currents{};  ///< mA, motors A to C as they are wired
  std::array<std::int16_t, 6> counters{};  ///< for set_counters
};

/// Bytes of a report, which are those of a command too, without a report id.
[[nodiscard]] constexpr std::size_t wooden_report_bytes(WoodenProtocol protocol) noexcept {
  return protocol == WoodenProtocol::v1 ? 8 : protocol == WoodenProtocol::v2 ? 14 : 64;
}

inline constexpr std::size_t longest_wooden_report = 64;

/// Reads a report; false where its length is not the protocol's. Leaves `connection` as it is.
[[nodiscard]] bool decode_wooden_report(WoodenProtocol protocol,
                                        std::span<const std::uint8_t> bytes,
                                        WoodenReport& report) noexcept;

/// A command as it is written: the report id 0, then the report, padded with zeros.
class WoodenPacket {
 public:
  /// With V1, whose counters cannot be set, `set_counters` gives no current and nothing else.
  WoodenPacket(WoodenProtocol protocol, const WoodenCommand& command) noexcept;

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {bytes_.data(), size_};
  }

 private:
  std::array<std::uint8_t, 1 + longest_wooden_report> bytes_{};
  std::size_t size_;
};

/// A current in whole mA, its magnitude at most `limit`; both in A. What is no number gives 0.
[[nodiscard]] std::int16_t limited_milliamperes(double current, double limit) noexcept;

/// Encoder D with the handle's button, which the board adds to it.
struct WoodenHandle {
  std::int16_t counter = 0;
  bool pressed = false;
};
[[nodiscard]] WoodenHandle wooden_handle(std::int16_t counter_d) noexcept;

}  // namespace spm::servo
