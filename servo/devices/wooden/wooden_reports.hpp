// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// The HID protocols of the WoodenHaptics family, as its public hosts and firmware use them. V1
/// sends reports by itself; V2 and V3 send one report for each command. None was tried on a device
/// here [U].
enum class WoodenProtocol : std::uint8_t { v1, v2, v3 };

[[nodiscard]] const char* to_string(WoodenProtocol protocol) noexcept;

/// +1 or -1 for each encoder, A to F, and each motor, A to C.
struct WoodenSigns {
  std::array<std::int8_t, 6> counts{};
  std::array<std::int8_t, 3> motors{};

  [[nodiscard]] bool operator==(const WoodenSigns&) const = default;
};

/// A report from the board.
struct WoodenReport {
  std::array<std::int16_t, 6> counters{};  ///< raw counts of encoders A to F; V1 has no D to F
  std::uint16_t sequence = 0;              ///< V1: increases with each report; else 0
  bool calibration_pressed = false;        ///< V2 and V3: set until the counters are set
  WoodenProtocol protocol = WoodenProtocol::v1;
  std::uint32_t connection = 0;  ///< increases each time that the board is opened
  WoodenSigns signs;             ///< of this board; zeros: those of the options
  bool signs_confirmed = false;  ///< by its user, some time
};

enum class WoodenRequest : std::uint8_t {
  currents,  ///< currents of the motors
  /// V2 and V3: new counts for all encoders; the motors get no current for one cycle
  set_counters,
};

/// A command to the board.
struct WoodenCommand {
  WoodenRequest request = WoodenRequest::currents;
  std::array<std::int16_t, 3> currents{};  ///< mA, motors A to C in the order of their wiring
  std::array<std::int16_t, 6> counters{};  ///< for set_counters
};

/// Size of a report in bytes, without a report id. Commands have the same size.
[[nodiscard]] constexpr std::size_t wooden_report_bytes(WoodenProtocol protocol) noexcept {
  return protocol == WoodenProtocol::v1 ? 8 : protocol == WoodenProtocol::v2 ? 14 : 64;
}

inline constexpr std::size_t longest_wooden_report = 64;

/// Reads a report. False if its length is not that of the protocol. Does not change `connection`.
[[nodiscard]] bool decode_wooden_report(WoodenProtocol protocol,
                                        std::span<const std::uint8_t> bytes,
                                        WoodenReport& report) noexcept;

/// A command in the form that is written: the report id 0, then the report, padded with zeros.
class WoodenPacket {
 public:
  /// With V1, whose counters cannot be set, `set_counters` sends no current and nothing else.
  WoodenPacket(WoodenProtocol protocol, const WoodenCommand& command) noexcept;

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {bytes_.data(), size_};
  }

 private:
  std::array<std::uint8_t, 1 + longest_wooden_report> bytes_{};
  std::size_t size_;
};

/// A current in whole mA, limited to a magnitude of `limit`; both arguments in A. NaN gives 0.
[[nodiscard]] std::int16_t limited_milliamperes(double current, double limit) noexcept;

/// Encoder D and the handle's button, which the board adds to its count.
struct WoodenHandle {
  std::int16_t counter = 0;
  bool pressed = false;
};
[[nodiscard]] WoodenHandle wooden_handle(std::int16_t counter_d) noexcept;

}  // namespace spm::servo
