// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace spm::servo {

/// Continues the count of a 16-bit encoder counter that wraps. Of the two possible steps from one
/// count to the next, the shorter one is assumed. The counter may therefore move by less than 32768
/// between two reports.
class EncoderUnwrap {
 public:
  /// Takes the next count. The first one after a reset is taken as it is.
  [[nodiscard]] std::int64_t next(std::int16_t count) noexcept {
    if (!known_) {
      total_ = count;
      known_ = true;
    } else {
      const auto step = static_cast<std::uint16_t>(static_cast<std::uint16_t>(count) -
                                                   static_cast<std::uint16_t>(last_));
      total_ += static_cast<std::int16_t>(step);
    }
    last_ = count;
    return total_;
  }

  /// Forgets the count: after the counter was set, or its device was plugged in again.
  void reset() noexcept { known_ = false; }

 private:
  std::int64_t total_ = 0;
  std::int16_t last_ = 0;
  bool known_ = false;
};

}  // namespace spm::servo
