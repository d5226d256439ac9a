// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"

struct hid_device_;  // hidapi's handle

namespace spm::servo {

/// One use of one HID device that is plugged in.
struct HidDevice {
  std::string path;
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t usage_page = 0;
  std::uint16_t usage = 0;
  int interface_number = -1;  ///< -1 where it has none
  std::string product_name;   ///< UTF-8, like the serial number; either may be empty
  std::string serial;
};

/// The HID devices that are plugged in, in the order of their paths. Empty if there is none, or no
/// USB at all.
[[nodiscard]] Result<std::vector<HidDevice>> list_hid_devices();

/// This process's use of hidapi: hid_init with the first user, hid_exit with the last.
class HidLibrary;

enum class HidUse : std::uint8_t {
  shared,  ///< other programs may read it too
  alone,  ///< no other program that asks for this too; a second one is told that the device is busy
};

/// One opening of a device, for one thread. hidapi keeps the last error text of each handle without
/// a lock, so a reading and a writing thread need a handle each.
class HidHandle {
 public:
  /// `what` names the device in messages. Errors: file_or_device, with different sentences for a
  /// missing permission, for a device in use and for one that is gone.
  [[nodiscard]] static Result<std::unique_ptr<HidHandle>> open(const HidDevice& device,
                                                               std::string_view what, HidUse use);

  HidHandle(const HidHandle&) = delete;
  HidHandle& operator=(const HidHandle&) = delete;
  ~HidHandle();

  /// Waits for a report, at most `milliseconds`. Returns its number of bytes; 0 if none came; -1 if
  /// the device is gone.
  [[nodiscard]] int read(std::span<std::uint8_t> bytes, int milliseconds) noexcept;
  /// Writes a report, the report id first. False if the device is gone.
  [[nodiscard]] bool write(std::span<const std::uint8_t> bytes) noexcept;
  /// Sets a feature report, its id first (0 if it has none). False if the device refuses it, or is
  /// gone.
  [[nodiscard]] bool send_feature(std::span<const std::uint8_t> bytes) noexcept;
  /// Reads the feature report whose id is in the first byte and whose size, with the id, is that of
  /// `bytes`. Returns how many bytes came, or -1 if the device refuses it, or is gone.
  [[nodiscard]] int get_feature(std::span<std::uint8_t> bytes) noexcept;
  /// The same for an input report, which is requested instead of waited for.
  [[nodiscard]] int get_input(std::span<std::uint8_t> bytes) noexcept;

 private:
  HidHandle(std::shared_ptr<HidLibrary> library, hid_device_* handle, int claim) noexcept;

  std::shared_ptr<HidLibrary> library_;
  hid_device_* handle_;
  int claim_;  ///< a file descriptor whose lock says that the device is in use, or -1
};

/// Which devices are acceptable.
struct HidFilter {
  std::string_view what;  ///< the device's name in messages
  std::function<bool(const HidDevice&)> fits;
  std::string serial;  ///< empty: any
};

/// A device with its handle.
struct OpenHid {
  HidDevice device;
  std::unique_ptr<HidHandle> handle;
};

/// Opens the first device that matches and can be opened. Errors: file_or_device; the error of the
/// last one tried, or that none is plugged in.
[[nodiscard]] Result<OpenHid> open_hid(const HidFilter& filter, HidUse use);

}  // namespace spm::servo
