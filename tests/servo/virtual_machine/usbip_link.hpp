// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace spm::test {

/// A transfer that the kernel asks a USB device for.
struct UsbTransfer {
  std::uint32_t number = 0;
  unsigned endpoint = 0;
  bool in = false;
  std::size_t length = 0;               ///< bytes wanted (IN) or sent (OUT)
  std::array<std::uint8_t, 8> setup{};  ///< of endpoint 0
  std::vector<std::uint8_t> data;       ///< sent
};

/// The kernel takes a transfer back.
struct UsbUnlink {
  std::uint32_t number = 0;
  std::uint32_t transfer = 0;
};

using UsbMessage = std::variant<UsbTransfer, UsbUnlink>;

/// A USB device at a port of the kernel's virtual host controller (vhci_hcd): USB/IP as
/// Documentation/usb/usbip_protocol.rst has it, without its tools and its network, since the
/// controller takes any stream socket. Plugged in from construction to destruction. Ends the
/// program where the kernel refuses.
class UsbIpLink {
 public:
  UsbIpLink();
  UsbIpLink(const UsbIpLink&) = delete;
  UsbIpLink& operator=(const UsbIpLink&) = delete;
  ~UsbIpLink();

  /// Waits for a message from the kernel. Returns nothing if none came in time.
  [[nodiscard]] std::optional<UsbMessage> receive(std::chrono::nanoseconds wait);
  /// Ends an OUT transfer, or one without data. `status`: 0 or a negative errno.
  void end(const UsbTransfer& transfer, int status);
  /// Ends an IN transfer with data.
  void end(const UsbTransfer& transfer, std::span<const std::uint8_t> data);
  /// Says what became of a transfer that was taken back.
  void end(const UsbUnlink& unlink, bool was_pending);

 private:
  void reply(const UsbTransfer& transfer, int status, std::size_t length,
             std::span<const std::uint8_t> data);
  void send(std::span<const std::uint8_t> bytes);

  int socket_;
};

}  // namespace spm::test
