// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>

#include "common/base/error.hpp"
#include "servo/devices/base/port.hpp"
#include "servo/devices/falcon/falcon_packet.hpp"
#include "servo/devices/falcon/falcon_usb.hpp"
#include "servo/devices/falcon/ftdi_stream.hpp"

struct libusb_transfer;

namespace spm::servo {

/// The packets of a Falcon whose firmware runs. Two reads of one USB packet are always submitted,
/// so that no answer waits for the next read.
class FalconPort final : public Port<FalconReport, FalconCommand> {
 public:
  /// Submits the reads. Errors: file_or_device.
  [[nodiscard]] static Result<std::unique_ptr<FalconPort>> start(std::unique_ptr<FalconUsb> usb);
  /// Cancels the reads.
  ~FalconPort() override;

  /// Waits for USB events, and takes the newest report among them.
  [[nodiscard]] Received receive(FalconReport& report) override;
  /// Sends one packet, and waits until the chip has it.
  [[nodiscard]] bool send(const FalconCommand& command) override;

 private:
  /// One submitted read.
  struct Read {
    std::array<std::uint8_t, ftdi_packet_size> bytes{};
    libusb_transfer* transfer = nullptr;
    FalconPort* port = nullptr;
  };

  explicit FalconPort(std::unique_ptr<FalconUsb> usb);
  [[nodiscard]] int post_all();
  static void ended(libusb_transfer* transfer);
  void take(Read& read);

  std::unique_ptr<FalconUsb> usb_;
  std::mutex mutex_;  ///< guards the members below: either thread may handle the other's USB events
  std::unique_ptr<std::array<Read, 2>> reads_;
  int posted_ = 0;
  bool closing_ = false;
  bool gone_ = false;
  bool fresh_ = false;
  FalconReport newest_;
  FalconParser parser_;
};

}  // namespace spm::servo
