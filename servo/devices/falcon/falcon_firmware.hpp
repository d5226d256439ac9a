// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "servo/devices/base/byte_link.hpp"

namespace spm::servo {

/// A firmware file that the user supplied. None comes with this program: it belongs to the device's
/// maker.
struct FalconFirmwareFile {
  std::string path;
  std::vector<std::uint8_t> bytes;
  std::string sha256;  ///< 64 hex digits
  bool known = false;  ///< whether it is a file that was seen before
};

/// Reads and checks a firmware file. Errors: file_or_device if it cannot be read; invalid_input if
/// its size or its first bytes cannot be a Falcon's firmware.
[[nodiscard]] Result<FalconFirmwareFile> read_falcon_firmware(const std::string& path);

/// How long the upload of the firmware may take.
struct FalconUploadLimits {
  int attempts = 10;  ///< of the whole sequence; it often fails, and public drivers repeat it too
  int calls = 25;     ///< of the boot program, in one attempt
  std::chrono::milliseconds back_off{100};  ///< after the first attempt; doubles each time
  std::chrono::milliseconds longest_back_off{1000};
};

/// Sets the line to the mode that the running firmware uses. Errors: file_or_device.
[[nodiscard]] Result<void> set_falcon_normal_mode(ByteLink& link);

/// Finds out, with packets of zero force, whether firmware runs; once started, it runs until power
/// is lost. Errors: file_or_device if the device is gone, or `stop` was set.
[[nodiscard]] Result<bool> falcon_firmware_runs(ByteLink& link, const std::atomic<bool>& stop);

/// Loads firmware into the device and starts it. After that the line is in normal mode. Gives up
/// after `limits`, or soon after `stop` is set. Errors: file_or_device, with the step that failed,
/// why, and the cure.
[[nodiscard]] Result<void> upload_falcon_firmware(ByteLink& link,
                                                  std::span<const std::uint8_t> firmware,
                                                  const std::atomic<bool>& stop,
                                                  const FalconUploadLimits& limits = {});

}  // namespace spm::servo
