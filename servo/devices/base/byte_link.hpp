// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spm::servo {

/// What became of a transfer.
enum class LinkStatus : std::uint8_t {
  done,
  timed_out,
  failed,  ///< refused by the device or garbled on the way; it may do when tried again
  gone,    ///< the device was unplugged
};

struct LinkResult {
  LinkStatus status = LinkStatus::done;
  std::size_t bytes = 0;  ///< that were carried, also where the status is not `done`
};

/// The serial line behind an FTDI chip, without the status that leads its packets. Blocks; used by
/// one thread.
class ByteLink {
 public:
  ByteLink() = default;
  ByteLink(const ByteLink&) = delete;
  ByteLink& operator=(const ByteLink&) = delete;
  virtual ~ByteLink() = default;

  /// A vendor request without data to the chip. A reset or purge of its receiving side also forgets
  /// what was received and not yet read.
  [[nodiscard]] virtual LinkStatus control(std::uint8_t request, std::uint16_t value) = 0;
  /// Sends all bytes.
  [[nodiscard]] virtual LinkResult write(std::span<const std::uint8_t> bytes,
                                         std::chrono::milliseconds timeout) = 0;
  /// Waits for data, and takes what has come, at least one byte where the status is `done`.
  [[nodiscard]] virtual LinkResult read(std::span<std::uint8_t> bytes,
                                        std::chrono::milliseconds timeout) = 0;
};

}  // namespace spm::servo
