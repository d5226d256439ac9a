// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace spm::servo {

/// How long readings and commands were under way, summed since the device was opened: a mean over
/// a while comes from two of these.
struct DelayCounts {
  std::uint64_t readings = 0;  ///< that ticks used, each time that one did
  std::uint64_t age_ns = 0;    ///< from when they came to when they were used
  std::uint64_t commands = 0;
  std::uint64_t sent_ns = 0;  ///< from when the loop gave them to when the device had them

  [[nodiscard]] bool operator==(const DelayCounts&) const noexcept = default;
};

}  // namespace spm::servo
