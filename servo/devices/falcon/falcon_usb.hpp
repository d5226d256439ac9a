// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "servo/devices/base/byte_link.hpp"
#include "servo/devices/base/device_ids.hpp"
#include "servo/devices/falcon/ftdi_stream.hpp"

struct libusb_context;
struct libusb_device_handle;

namespace spm::servo {

struct UsbContextDeleter {
  void operator()(libusb_context* context) const noexcept;
};
using UsbContext = std::unique_ptr<libusb_context, UsbContextDeleter>;

struct UsbHandleDeleter {
  void operator()(libusb_device_handle* handle) const noexcept;
};
using UsbHandle = std::unique_ptr<libusb_device_handle, UsbHandleDeleter>;

/// A Falcon's USB ids: FTDI's vendor id, and the product id that its chip was given.
inline constexpr std::uint16_t falcon_vendor = falcon_ids.vendor,
                               falcon_product = falcon_ids.product;

/// The endpoint from which a Falcon's FTDI chip is read.
inline constexpr std::uint8_t falcon_in_endpoint = 0x81;

/// The USB paths, BUS-PORT.PORT, of all Falcons that are plugged in. Errors: file_or_device.
[[nodiscard]] Result<std::vector<std::string>> list_falcons();

/// What to do about a program that has claimed the device.
enum class UsbClaim : std::uint8_t {
  respect,    ///< leave the device to it
  take_over,  ///< take the device from it; it then finds the device lost
};

/// A Falcon's FTDI chip over libusb, with its interface claimed until the end.
class FalconUsb final : public ByteLink {
 public:
  /// Opens the Falcon at a USB path, BUS-PORT.PORT; or, if that is empty, the first one that may be
  /// opened. `product`: its USB product id. Errors: file_or_device, with the missing permission or
  /// the program that uses it.
  [[nodiscard]] static Result<std::unique_ptr<FalconUsb>> open(
      const std::string& path, std::uint16_t product = falcon_product,
      UsbClaim claim = UsbClaim::respect);
  ~FalconUsb() override;

  [[nodiscard]] LinkStatus control(std::uint8_t request, std::uint16_t value) override;
  [[nodiscard]] LinkResult write(std::span<const std::uint8_t> bytes,
                                 std::chrono::milliseconds timeout) override;
  [[nodiscard]] LinkResult read(std::span<std::uint8_t> bytes,
                                std::chrono::milliseconds timeout) override;

  /// Where it is plugged in, BUS-PORT.PORT.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] libusb_context* context() const noexcept { return context_.get(); }
  [[nodiscard]] libusb_device_handle* handle() const noexcept { return handle_.get(); }

 private:
  FalconUsb(UsbContext context, UsbHandle handle, std::string path);

  UsbContext context_;
  UsbHandle handle_;
  std::string path_;
  std::array<std::uint8_t, ftdi_packet_size> received_{};
  std::size_t begin_ = 0, end_ = 0;  ///< of the data that was received and not yet read
};

}  // namespace spm::servo
