// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/motion/recording.hpp"

namespace spm::servo {

/// What is marked on a recording's time line.
enum class MarkKind : std::uint8_t {
  off,        ///< the force was zero for a cause
  lost,       ///< ticks are missing before this one
  late,       ///< the tick was not finished before the next was due
  capped,     ///< force or torque met its cap
  edited,     ///< an edited scene was taken up
  exchanged,  ///< assets were opened, or opened again
};
inline constexpr std::size_t mark_kinds = 6;
[[nodiscard]] const char* to_string(MarkKind kind) noexcept;

/// A stretch of ticks. What comes again within `mark_gap_seconds` goes on.
struct Mark {
  MarkKind kind = MarkKind::off;
  std::uint64_t first = 0, last = 0;  ///< on the loop's grid, both included
  std::uint16_t cause = 0;            ///< of `off`
};
inline constexpr double mark_gap_seconds = 0.05;

/// Marks of one device, by their beginning. Of each kind at most `most` are kept, the first ones;
/// `found` says how many there are.
struct Marks {
  std::vector<Mark> list;
  std::array<std::size_t, mark_kinds> found{};
};
[[nodiscard]] Marks marks_of(const Recording& recording, std::size_t device,
                             std::size_t most = 200);

/// What to do about a cause of zero force, by its name in a recording; empty for a name that this
/// program does not know.
[[nodiscard]] std::string cure_of_cause(const std::string& name);

}  // namespace spm::servo
