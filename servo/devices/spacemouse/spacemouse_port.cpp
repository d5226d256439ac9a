// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/spacemouse/spacemouse_port.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "servo/devices/base/device_ids.hpp"

namespace spm::servo {

namespace {

constexpr std::string_view name = "SpaceMouse";
constexpr std::uint8_t light_id = 4;

bool is_spacemouse(const HidDevice& device) {
  const auto match =
      match_hid({{device.vendor, device.product}, device.usage_page, device.usage, false});
  return match && std::string_view(match->driver) == "spacemouse";
}

}  // namespace

Result<std::unique_ptr<SpaceMousePort>> SpaceMousePort::open(const SpaceMouseOptions& options) {
  const HidFilter filter{name, is_spacemouse, options.serial};
  auto opened = open_hid(filter, HidUse::shared);
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  auto writer = HidHandle::open(opened->device, name, HidUse::shared);
  if (!writer) return tl::make_unexpected(std::move(writer.error()));
  return std::unique_ptr<SpaceMousePort>(
      new SpaceMousePort(std::move(opened->device), std::move(opened->handle), std::move(*writer)));
}

Received SpaceMousePort::receive(SpaceMouseState& state) {
  std::array<std::uint8_t, longest_spacemouse_report> buffer{};
  const int count = reader_->read(buffer, static_cast<int>(port_wait.count()));
  if (count < 0) return Received::gone;
  const std::span<const std::uint8_t> bytes(buffer.data(), static_cast<std::size_t>(count));
  if (!take_spacemouse_report(bytes, latest_)) return Received::nothing;
  state = latest_;
  return Received::report;
}

bool SpaceMousePort::send(const SpaceMouseCommand& command) {
  const std::array<std::uint8_t, 2> report{light_id, static_cast<std::uint8_t>(command.light)};
  static_cast<void>(writer_->write(report));
  return true;
}

}  // namespace spm::servo
