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
  std::string product_name;   ///< UTF-8, as is the serial number; either may be empty
  std::string serial;
};

/// What is plugged in, in the order of the paths. Empty where there is none, or no USB at all.
[[nodiscard]] Result<std::vector<HidDevice>> list_hid_devices();

/// hidapi's use by this process: hid_init with the first, hid_exit with the last.
class HidLibrary;

enum class HidUse : std::uint8_t {
  shared,  ///< other programs may read it too
  alone,   ///< no other program that asks so too; a second one is told that it is busy
};

/// One opening of a device, for one thread: hidapi keeps each handle's last error text without a
/// lock, so that a thread that reads and one that writes need a handle each.
class HidHandle {
 public:
  /// `what` names the device in messages. Errors: file_or_device, a sentence of its own for a
  /// missing permission, for a device in use and for one that is gone.
  [[nodiscard]] static Result<std::unique_ptr<HidHandle>> open(const HidDevice& device,
                                                               std::string_view what, HidUse use);

  HidHandle(const HidHandle&) = delete;
  HidHandle& operator=(const HidHandle&) = delete;
  ~HidHandle();

  /// Waits for a report, at most so many ms: its bytes, 0 where none came, -1 where the device is
  /// gone.
  [[nodiscard]] int read(std::span<std::uint8_t> bytes, int milliseconds) noexcept;
  /// Writes a report, the report id first; false where the device is gone.
  [[nodiscard]] bool write(std::span<const std::uint8_t> bytes) noexcept;
  /// Sets a feature report, its id first (0 where it has none); false where the device refuses it,
  /// or is gone.
  [[nodiscard]] bool send_feature(std::span<const std::uint8_t> bytes) noexcept;
  /// Asks for the feature report whose id is in the first byte, and which has so many bytes with
  /// it: how many came, or -1 where the device refuses it, or is gone.
  [[nodiscard]] int get_feature(std::span<std::uint8_t> bytes) noexcept;
  /// The same for an input report, which is asked instead of waited for.
  [[nodiscard]] int get_input(std::span<std::uint8_t> bytes) noexcept;

 private:
  HidHandle(std::shared_ptr<HidLibrary> library, hid_device_* handle, int claim) noexcept;

  std::shared_ptr<HidLibrary> library_;
  hid_device_* handle_;
  int claim_;  ///< a file descriptor whose lock says that the device is in use, or -1
};

/// Which devices would do.
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

/// Opens the first device that fits and can be opened. Errors: file_or_device; that of the last one
/// tried, or that none is plugged in.
[[nodiscard]] Result<OpenHid> open_hid(const HidFilter& filter, HidUse use);

}  // namespace spm::servo
