// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace spm::servo {

/// Size of a packet in bytes, in both directions.
inline constexpr std::size_t falcon_packet_size = 16;

/// Largest documented motor command; larger ones are limited to it.
inline constexpr int falcon_motor_limit = 4096;

/// Value of FalconReport::homed if each of the three encoders knows where it is.
inline constexpr std::uint8_t falcon_all_homed = 7;

/// A command to a Falcon.
struct FalconCommand {
  std::array<std::int16_t, 3> motors{};  ///< of the top leg, the right one, the left one
  /// Set in every packet: without it the device does not home, and its homed bits have no meaning.
  bool homing = true;
  bool red = false, green = false, blue = false;  ///< its lights
};

/// A report from a Falcon.
struct FalconReport {
  std::array<std::int16_t, 3> encoders{};  ///< counts, in the order of the motors
  std::uint8_t buttons = 0;  ///< bit 0 right (plus), 1 front (lightning), 2 centre, 3 left (minus)
  std::uint8_t homed = 0;    ///< one bit for each encoder; valid while the homing bit is sent
};

/// The packet of a command.
[[nodiscard]] std::array<std::uint8_t, falcon_packet_size> encode(
    const FalconCommand& command) noexcept;

/// The report in a complete packet. None if its start, its end or its encoder bytes are invalid.
[[nodiscard]] std::optional<FalconReport> decode_falcon_report(
    std::span<const std::uint8_t, falcon_packet_size> packet) noexcept;

/// Finds reports in a stream of bytes. If a packet is cut short or bytes are wrong, it drops one
/// byte and searches again.
class FalconParser {
 public:
  /// Takes the next byte. Returns the report that this byte completes, if any.
  [[nodiscard]] std::optional<FalconReport> take(std::uint8_t byte) noexcept;

  /// The number of bytes that belonged to no report.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

  /// Forgets a packet that has begun.
  void reset() noexcept { held_ = 0; }

 private:
  /// Drops the oldest byte, and the following ones up to a byte that can begin a packet.
  void drop() noexcept;

  std::array<std::uint8_t, falcon_packet_size> bytes_{};
  std::size_t held_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace spm::servo
