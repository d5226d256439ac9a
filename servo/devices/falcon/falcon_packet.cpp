// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_packet.hpp"

#include <algorithm>

namespace spm::servo {

namespace {

// The protocol as public drivers use it: every nibble is one byte from 'A' on, the lowest nibble
// first.
constexpr std::uint8_t packet_begin = '<', packet_end = '>', zero_nibble = 'A', top_nibble = 'P';

constexpr std::size_t number_bytes = 4;  // for one int16
constexpr std::size_t flags_at = 1 + 3 * number_bytes, unused_at = flags_at + 1;

constexpr unsigned homing_flag = 1, green_flag = 2, blue_flag = 4, red_flag = 8;
constexpr unsigned button_bits = 0x0F, homed_shift = 4;

void put_number(std::uint8_t* bytes, int value) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  for (std::size_t i = 0; i < number_bytes; ++i) {
    bytes[i] = static_cast<std::uint8_t>(zero_nibble + ((bits >> (4 * i)) & 0x0FU));
  }
}

std::int16_t get_number(const std::uint8_t* bytes) noexcept {
  unsigned bits = 0;
  for (std::size_t i = 0; i < number_bytes; ++i) {
    bits |= ((bytes[i] - unsigned{zero_nibble}) & 0x0FU) << (4 * i);
  }
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits));
}

}  // namespace

std::array<std::uint8_t, falcon_packet_size> encode(const FalconCommand& command) noexcept {
  std::array<std::uint8_t, falcon_packet_size> packet{};
  packet.front() = packet_begin;
  for (std::size_t i = 0; i < command.motors.size(); ++i) {
    put_number(&packet[1 + i * number_bytes],
               std::clamp<int>(command.motors[i], -falcon_motor_limit, falcon_motor_limit));
  }
  const unsigned flags = (command.homing ? homing_flag : 0) | (command.green ? green_flag : 0) |
                         (command.blue ? blue_flag : 0) | (command.red ? red_flag : 0);
  packet[flags_at] = static_cast<std::uint8_t>(zero_nibble + flags);
  packet[unused_at] = zero_nibble;
  packet.back() = packet_end;
  return packet;
}

std::optional<FalconReport> decode_falcon_report(
    std::span<const std::uint8_t, falcon_packet_size> packet) noexcept {
  if (packet.front() != packet_begin || packet.back() != packet_end) return std::nullopt;
  for (std::size_t i = 1; i < flags_at; ++i) {
    if (packet[i] < zero_nibble || packet[i] > top_nibble) return std::nullopt;
  }
  FalconReport report;
  for (std::size_t i = 0; i < report.encoders.size(); ++i) {
    report.encoders[i] = get_number(&packet[1 + i * number_bytes]);
  }
  const unsigned flags = packet[flags_at] - unsigned{zero_nibble};
  report.buttons = static_cast<std::uint8_t>(flags & button_bits);
  report.homed = static_cast<std::uint8_t>((flags >> homed_shift) & falcon_all_homed);
  return report;
}

std::optional<FalconReport> FalconParser::take(std::uint8_t byte) noexcept {
  bytes_[held_++] = byte;
  if (bytes_.front() != packet_begin) {
    drop();
    return std::nullopt;
  }
  if (held_ < bytes_.size()) return std::nullopt;
  const std::optional<FalconReport> report = decode_falcon_report(bytes_);
  if (report) {
    held_ = 0;
  } else {
    drop();
  }
  return report;
}

void FalconParser::drop() noexcept {
  std::uint8_t* const end = bytes_.data() + held_;
  std::uint8_t* const next = std::find(bytes_.data() + 1, end, packet_begin);
  dropped_ += static_cast<std::uint64_t>(next - bytes_.data());
  held_ = static_cast<std::size_t>(end - next);
  std::copy(next, end, bytes_.data());
}

}  // namespace spm::servo
