// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace spm::servo {

/// Bytes of a packet, both ways.
inline constexpr std::size_t falcon_packet_size = 16;

/// Largest motor command that is documented; more is cut to it.
inline constexpr int falcon_motor_limit = 4096;

/// Bits of FalconReport::homed when each of the three encoders knows where it is.
inline constexpr std::uint8_t falcon_all_homed = 7;

/// What is sent to a Falcon.
struct FalconCommand {
  std::array<std::int16_t, 3> motors{};  ///< of the top leg, the right one, the left one
  /// In every packet: without it the device does not home, and its homed bits mean nothing.
  bool homing = true;
  bool red = false, green = false, blue = false;  ///< its lights
};

/// What a Falcon answers.
struct FalconReport {
  std::array<std::int16_t, 3> encoders{};  ///< counts, in the order of the motors
  std::uint8_t buttons = 0;  ///< bit 0 right (plus), 1 front (lightning), 2 centre, 3 left (minus)
  std::uint8_t homed = 0;    ///< a bit an encoder; valid while the homing bit is sent
};

/// The command as it goes over the line.
[[nodiscard]] std::array<std::uint8_t, falcon_packet_size> encode(
    const FalconCommand& command) noexcept;

/// The report in a whole packet; none where its marks or its encoder bytes cannot be.
[[nodiscard]] std::optional<FalconReport> decode_falcon_report(
    std::span<const std::uint8_t, falcon_packet_size> packet) noexcept;

/// Finds reports in a stream of bytes: where a packet is cut short or bytes are wrong, it drops one
/// byte and searches again.
class FalconParser {
 public:
  /// Takes the next byte; gives the report that it completes, if it does.
  [[nodiscard]] std::optional<FalconReport> take(std::uint8_t byte) noexcept;

  /// Counts the bytes that belonged to no report.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

  /// Forgets a packet that was begun.
  void reset() noexcept { held_ = 0; }

 private:
  /// Drops the oldest byte, and those after it until one that may begin a packet.
  void drop() noexcept;

  std::array<std::uint8_t, falcon_packet_size> bytes_{};
  std::size_t held_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace spm::servo
