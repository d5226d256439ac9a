// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/wooden_port.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>
#include <variant>

#include "servo/devices/base/device_ids.hpp"

namespace spm::servo {

namespace {

constexpr std::string_view name = "WoodenHaptics";

/// How long to wait for a first report; a V1 board sends about one each millisecond.
constexpr std::chrono::milliseconds first_report_wait{100};
constexpr std::chrono::milliseconds first_report_step{10};

/// One byte more than the longest report, so that a longer one can be recognised.
using Buffer = std::array<std::uint8_t, longest_wooden_report + 1>;

bool is_teensy(const HidDevice& device) noexcept {
  return DeviceIds{device.vendor, device.product} == wooden_teensy_ids;
}

/// Waits for a report of V1 or V2, in steps, so that `stop` is noticed. Returns the protocol, or
/// the length of the last report, which fits neither: 0 if none came, -1 if the board is gone.
std::variant<WoodenProtocol, int> protocol_by_report(HidHandle& reader,
                                                     const std::atomic<bool>& stop) {
  Buffer buffer{};
  int seen = 0;
  for (auto waited = std::chrono::milliseconds(0); waited < first_report_wait && !stop.load();
       waited += first_report_step) {
    const int count = reader.read(buffer, static_cast<int>(first_report_step.count()));
    if (count < 0) return count;
    for (const WoodenProtocol protocol : {WoodenProtocol::v1, WoodenProtocol::v2}) {
      if (count == static_cast<int>(wooden_report_bytes(protocol))) return protocol;
    }
    if (count > 0) seen = count;
  }
  return seen;
}

/// Detects V1 or V2 by the length of a report. V1 sends reports by itself, so a quiet board can
/// only be V2; it is then sent a command without current.
Result<WoodenProtocol> protocol_by_length(HidHandle& reader, const std::atomic<bool>& stop) {
  auto found = protocol_by_report(reader, stop);
  if (found == std::variant<WoodenProtocol, int>(0)) {
    static_cast<void>(reader.write(WoodenPacket(WoodenProtocol::v2, {}).bytes()));
    found = protocol_by_report(reader, stop);
  }
  if (const auto* protocol = std::get_if<WoodenProtocol>(&found)) return *protocol;
  const int count = std::get<int>(found);
  if (count <= 0) {
    return fail(ExitCode::file_or_device,
                fmt::format("the {} is plugged in, but sends no report: unplug it, plug it in "
                            "again, and check that its board runs its firmware",
                            name));
  }
  return fail(ExitCode::file_or_device,
              fmt::format("the {} sends reports of {} bytes, which is neither V1 (8) nor V2 (14): "
                          "check the board's firmware",
                          name, count));
}

tl::unexpected<Error> unnamed_board() {
  return fail(ExitCode::file_or_device,
              fmt::format("no {} is plugged in but a board with the ids {:04x}:{:04x}, which any "
                          "Teensy with raw HID has: if it is one, name it, with protocol=v3 or its "
                          "serial=, which spm-servo devices shows",
                          name, wooden_teensy_ids.vendor, wooden_teensy_ids.product));
}

}  // namespace

bool is_wooden_board(const HidDevice& device, std::optional<WoodenProtocol> protocol) noexcept {
  const auto match = match_hid({{device.vendor, device.product},
                                device.usage_page,
                                device.usage,
                                false,
                                device.product_name});
  if (!match || std::string_view(match->driver) != "woodenhaptics") return false;
  return !protocol || (*protocol == WoodenProtocol::v3) == is_teensy(device);
}

Result<std::unique_ptr<WoodenPort>> WoodenPort::open(const WoodenOptions& options,
                                                     std::uint32_t connection,
                                                     const std::atomic<bool>& stop, HidUse use) {
  bool is_one_unnamed = false;
  const HidFilter filter{name,
                         [&options, &is_one_unnamed](const HidDevice& device) {
                           if (!is_wooden_board(device, options.protocol) ||
                               (!options.path.empty() && device.path != options.path)) {
                             return false;
                           }
                           const bool unnamed = is_teensy(device) && !options.name_a_board();
                           is_one_unnamed = is_one_unnamed || unnamed;
                           return !unnamed;
                         },
                         options.serial};
  auto opened = open_hid(filter, use);
  if (!opened && is_one_unnamed) return unnamed_board();
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  auto writer = HidHandle::open(opened->device, name, HidUse::shared);
  if (!writer) return tl::make_unexpected(std::move(writer.error()));

  WoodenProtocol protocol = WoodenProtocol::v3;
  if (options.protocol) {
    protocol = *options.protocol;
  } else if (!is_teensy(opened->device)) {
    const auto found = protocol_by_length(*opened->handle, stop);
    if (!found) return tl::make_unexpected(found.error());
    protocol = *found;
  }
  return std::unique_ptr<WoodenPort>(new WoodenPort(std::move(opened->device),
                                                    std::move(opened->handle), std::move(*writer),
                                                    protocol, connection));
}

Received WoodenPort::receive(WoodenReport& report) {
  Buffer buffer{};
  for (auto waited = std::chrono::milliseconds(0); waited < port_wait;
       waited += wooden_kick_after) {
    const int count = reader_->read(buffer, static_cast<int>(wooden_kick_after.count()));
    if (count < 0) return Received::gone;
    if (count > 0) {
      const std::span<const std::uint8_t> bytes(buffer.data(), static_cast<std::size_t>(count));
      if (!decode_wooden_report(protocol_, bytes, report)) return Received::nothing;
      report.connection = connection_;
      report.signs = signs_;
      report.signs_confirmed = signs_confirmed_;
      return Received::report;
    }
    if (protocol_ != WoodenProtocol::v1 && !reader_->write(WoodenPacket(protocol_, {}).bytes())) {
      return Received::gone;
    }
  }
  return Received::nothing;
}

bool WoodenPort::send(const WoodenCommand& command) {
  return writer_->write(WoodenPacket(protocol_, command).bytes());
}

}  // namespace spm::servo
