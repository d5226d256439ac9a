// SPDX-License-Identifier: Apache-2.0
/// A Novint Falcon that a real kernel takes for one: an FTDI chip at the kernel's virtual host
/// controller, and behind its serial line the scripted Falcon of the other tests.
///
///     usbip_falcon [unplug=PACKETS:MS] [times=COUNT] [power=lost] report=FILE
///
/// Ends at SIGTERM, and writes what the Falcon saw (JSON); with exit code 70 where the host broke
/// its rules.
#include <linux/usb/ch9.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/servo/devices/falcon/scripted_falcon.hpp"
#include "tests/servo/virtual_machine/emulator_program.hpp"
#include "tests/servo/virtual_machine/usbip_link.hpp"

namespace spm::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int broken_rules_code = 70;
constexpr std::size_t guest_firmware_size = 8492;  // of the file that the guest has
constexpr milliseconds longest_wait{50};           // between two looks at the signal

// As an FT232R without a serial number gives them.
constexpr std::array<std::uint8_t, 18> device_descriptor{0x12, 0x01, 0x00, 0x02, 0x00, 0x00,
                                                         0x00, 0x08, 0x03, 0x04, 0x48, 0xCB,
                                                         0x00, 0x06, 0x01, 0x02, 0x00, 0x01};
constexpr std::array<std::uint8_t, 32> configuration_descriptor{
    0x09, 0x02, 0x20, 0x00, 0x01, 0x01, 0x00, 0x80, 0x2D,  // bus powered, 90 mA
    0x09, 0x04, 0x00, 0x00, 0x02, 0xFF, 0xFF, 0xFF, 0x02,  // one interface
    0x07, 0x05, 0x81, 0x02, 0x40, 0x00, 0x00,              // bulk in
    0x07, 0x05, 0x02, 0x02, 0x40, 0x00, 0x00};             // bulk out
constexpr std::array<std::uint8_t, 4> languages{0x04, USB_DT_STRING, 0x09, 0x04};
constexpr unsigned in_endpoint = 1, out_endpoint = 2;

std::vector<std::uint8_t> string_descriptor(std::string_view text) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(2 + 2 * text.size()), USB_DT_STRING};
  for (const char letter : text) {
    bytes.push_back(static_cast<std::uint8_t>(letter));
    bytes.push_back(0);
  }
  return bytes;
}

/// A descriptor by its kind and index; empty where there is none.
std::vector<std::uint8_t> descriptor(unsigned kind, unsigned index) {
  if (kind == USB_DT_DEVICE) return {device_descriptor.begin(), device_descriptor.end()};
  if (kind == USB_DT_CONFIG) {
    return {configuration_descriptor.begin(), configuration_descriptor.end()};
  }
  if (kind != USB_DT_STRING || index > 2) return {};
  if (index == 0) return {languages.begin(), languages.end()};
  return string_descriptor(index == 1 ? "Novint" : "Falcon");
}

/// The FTDI chip, as long as it is plugged in.
class Chip {
 public:
  explicit Chip(ScriptedFalcon& falcon) : falcon_(falcon) {
    falcon_.outgoing().clear();  // it has its power from the cable
  }

  /// Waits a while for a message from the kernel, or until data is due; then handles both.
  void serve() {
    const auto message = link_.receive(next_wait());
    if (message) {
      std::visit([this](const auto& what) { take(what); }, *message);
    }
    send_due();
  }

 private:
  [[nodiscard]] steady_clock::duration latency() const {
    return milliseconds(falcon_.latency_ms());
  }

  [[nodiscard]] steady_clock::duration next_wait() const {
    if (reading_.empty()) return longest_wait;
    return std::min<steady_clock::duration>(last_ + latency() - steady_clock::now(), longest_wait);
  }

  void take(const UsbTransfer& transfer) {
    if (transfer.endpoint == 0) {
      control(transfer);
    } else if (transfer.endpoint == in_endpoint && transfer.in) {
      reading_.push_back(transfer);
    } else if (transfer.endpoint == out_endpoint && !transfer.in) {
      falcon_.receive(transfer.data);
      link_.end(transfer, 0);
    } else {
      link_.end(transfer, -EPIPE);
    }
  }

  void take(const UsbUnlink& unlink) {
    const auto found = std::find_if(
        reading_.begin(), reading_.end(),
        [&unlink](const UsbTransfer& transfer) { return transfer.number == unlink.transfer; });
    const bool was_pending = found != reading_.end();
    if (was_pending) reading_.erase(found);
    link_.end(unlink, was_pending);
  }

  void control(const UsbTransfer& transfer) {
    const unsigned kind = transfer.setup[0], request = transfer.setup[1];
    const auto value = static_cast<std::uint16_t>(transfer.setup[2] | transfer.setup[3] << 8);
    if (kind == (USB_DIR_OUT | USB_TYPE_VENDOR)) {
      falcon_.control(static_cast<std::uint8_t>(request), value);
      link_.end(transfer, 0);
    } else if (kind == USB_DIR_IN && request == USB_REQ_GET_DESCRIPTOR) {
      const auto bytes = descriptor(value >> 8U, value & 0xFFU);
      bytes.empty() ? link_.end(transfer, -EPIPE) : link_.end(transfer, bytes);
    } else if (kind == USB_DIR_IN && request == USB_REQ_GET_STATUS) {
      link_.end(transfer, std::array<std::uint8_t, 2>{});
    } else if ((kind & USB_TYPE_MASK) == USB_TYPE_STANDARD && (kind & USB_DIR_IN) == 0) {
      link_.end(transfer, 0);
    } else {
      link_.end(transfer, -EPIPE);
    }
  }

  /// Sends a packet, two status bytes before its data, when it is full or its time has come.
  void send_due() {
    constexpr std::size_t packet_data = 62;
    std::deque<std::uint8_t>& answers = falcon_.outgoing();
    const auto now = steady_clock::now();
    while (!reading_.empty() && (answers.size() >= packet_data || now - last_ >= latency())) {
      std::vector<std::uint8_t> packet{0x01, 0x60};
      const auto data =
          answers.begin() + static_cast<std::ptrdiff_t>(std::min(answers.size(), packet_data));
      packet.insert(packet.end(), answers.begin(), data);
      answers.erase(answers.begin(), data);
      link_.end(reading_.front(), packet);
      reading_.pop_front();
      last_ = now;
    }
  }

  ScriptedFalcon& falcon_;
  UsbIpLink link_;
  std::deque<UsbTransfer> reading_;
  steady_clock::time_point last_{};
};

nlohmann::ordered_json seen_by(const ScriptedFalcon& falcon) {
  return {{"boots", falcon.boots()},
          {"loaded_bytes", falcon.loaded().size()},
          {"packets", falcon.packets()},
          {"packets_with_homing", falcon.homing_packets()},
          {"wrong_packets", falcon.wrong_packets()},
          {"pushing_packets", falcon.pushing_packets()},
          {"pushes_before_homing", falcon.early_pushes()},
          {"largest_motor", falcon.largest_motor()},
          {"last_motors", falcon.motors()}};
}

int run(const EmulatorOptions& options) {
  enter_emulator();
  ScriptedFalcon falcon(guest_firmware_size);
  auto chip = std::make_unique<Chip>(falcon);
  int unplugged = 0;
  std::uint64_t packets_before = 0, pushes_before = 0;
  while (!told_to_end()) {
    chip->serve();
    if (options.unplug_after == 0 || unplugged == options.times ||
        falcon.packets() - packets_before < options.unplug_after) {
      continue;
    }
    chip.reset();
    ++unplugged;
    if (options.loses_power) falcon.lose_power();
    std::this_thread::sleep_for(options.away);
    packets_before = falcon.packets();
    pushes_before = falcon.pushing_packets();
    chip = std::make_unique<Chip>(falcon);
  }
  chip.reset();
  nlohmann::ordered_json seen = seen_by(falcon);
  seen["unplugged"] = unplugged;
  seen["pushing_packets_since_plugged_in"] = falcon.pushing_packets() - pushes_before;
  write_report(options.report, seen);
  const bool rules_kept = falcon.homing_packets() == falcon.packets() &&
                          falcon.wrong_packets() == 0 && falcon.early_pushes() == 0;
  return rules_kept ? 0 : broken_rules_code;
}

}  // namespace
}  // namespace spm::test

int main(int count, char** arguments) try {
  const auto options = spm::test::parse_emulator_options(count, arguments);
  if (!options || !options->words.empty() || options->report.empty()) {
    std::fprintf(
        stderr, "usage: usbip_falcon [unplug=PACKETS:MS] [times=COUNT] [power=lost] report=FILE\n");
    return 1;
  }
  return spm::test::run(*options);
} catch (const std::exception& problem) {
  std::fprintf(stderr, "usbip_falcon: %s\n", problem.what());
  return 4;
}
