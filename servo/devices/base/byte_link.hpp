// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// The result of a transfer.
enum class LinkStatus : std::uint8_t {
  done,
  timed_out,
  failed,  ///< refused by the device or garbled on the way; another try may succeed
  gone,    ///< the device was unplugged
};

struct LinkResult {
  LinkStatus status = LinkStatus::done;
  std::size_t bytes = 0;  ///< that were transferred, even if the status is not `done`
};

/// The serial line behind an FTDI chip, without the status bytes at the head of its packets. Calls
/// block. Used by one thread.
class ByteLink {
 public:
  ByteLink() = default;
  ByteLink(const ByteLink&) = delete;
  ByteLink& operator=(const ByteLink&) = delete;
  virtual ~ByteLink() = default;

  /// Sends the chip a vendor request without data. A reset or purge of its receiving side also
  /// discards what was received and not yet read.
  [[nodiscard]] virtual LinkStatus control(std::uint8_t request, std::uint16_t value) = 0;
  /// Sends all bytes.
  [[nodiscard]] virtual LinkResult write(std::span<const std::uint8_t> bytes,
                                         std::chrono::milliseconds timeout) = 0;
  /// Waits for data, and takes what has arrived: at least one byte if the status is `done`.
  [[nodiscard]] virtual LinkResult read(std::span<std::uint8_t> bytes,
                                        std::chrono::milliseconds timeout) = 0;
};

}  // namespace spm::servo
