// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_reports.hpp"

#include <algorithm>
#include <cmath>

namespace spm::servo {

namespace {

/// If the count is above this, the handle's button is pressed and has added this amount.
constexpr std::int16_t pressed_above = 5000;
constexpr std::int16_t pressed_adds = 10000;

/// The numbers in a report have 16 bits, the lower byte first.
std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t index) noexcept {
  return static_cast<std::uint16_t>(bytes[2 * index] | (bytes[2 * index + 1] << 8));
}

}  // namespace

const char* to_string(WoodenProtocol protocol) noexcept {
  switch (protocol) {
    case WoodenProtocol::v1:
      return "v1";
    case WoodenProtocol::v2:
      return "v2";
    case WoodenProtocol::v3:
      return "v3";
  }
  return "";
}

bool decode_wooden_report(WoodenProtocol protocol, std::span<const std::uint8_t> bytes,
                          WoodenReport& report) noexcept {
  if (bytes.size() != wooden_report_bytes(protocol)) return false;
  const bool first = protocol == WoodenProtocol::v1;
  const std::size_t counters = first ? 3 : 6;
  report.counters = {};
  for (std::size_t i = 0; i < counters; ++i) {
    report.counters[i] = static_cast<std::int16_t>(word(bytes, i));
  }
  report.sequence = first ? word(bytes, 3) : std::uint16_t{0};
  report.calibration_pressed = !first && word(bytes, 6) == 1;
  report.protocol = protocol;
  return true;
}

WoodenPacket::WoodenPacket(WoodenProtocol protocol, const WoodenCommand& command) noexcept
    : size_(1 + wooden_report_bytes(protocol)) {
  const auto put = [this](std::size_t index, std::int16_t value) {
    const auto bits = static_cast<std::uint16_t>(value);
    bytes_[1 + 2 * index] = static_cast<std::uint8_t>(bits & 0xFFU);
    bytes_[2 + 2 * index] = static_cast<std::uint8_t>(bits >> 8U);
  };
  if (command.request == WoodenRequest::currents) {
    for (std::size_t i = 0; i < 3; ++i) put(i, command.currents[i]);
    return;
  }
  if (protocol == WoodenProtocol::v1) return;
  // The counts of D to F are in the place of the currents, those of A to C after the command.
  for (std::size_t i = 0; i < 3; ++i) put(i, command.counters[i + 3]);
  put(3, 1);
  for (std::size_t i = 0; i < 3; ++i) put(i + 4, command.counters[i]);
}

std::int16_t limited_milliamperes(double current, double limit) noexcept {
  if (!std::isfinite(current) || !(limit > 0)) return 0;
  // Rounded towards zero, so that rounding never exceeds the limit.
  const double most = std::min(std::floor(limit * 1000), 32767.0);
  return static_cast<std::int16_t>(std::clamp(std::trunc(current * 1000), -most, most));
}

WoodenHandle wooden_handle(std::int16_t counter_d) noexcept {
  if (counter_d <= pressed_above) return {counter_d, false};
  return {static_cast<std::int16_t>(counter_d - pressed_adds), true};
}

}  // namespace spm::servo
