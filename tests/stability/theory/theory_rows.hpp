// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace spm::stability {

/// One figure from theory, compared with what the plant does.
struct TheoryRow {
  std::string criterion;  ///< what is compared: such as `eigenvalue` or `passivity-encoder`
  std::string kind;       ///< `stability` or `passivity`: two borders, never one
  std::string settings;   ///< words with figures
  double expected = 0;    ///< of the criterion
  double measured = 0;    ///< of the plant; same unit
  std::string unit;

  /// Deviation of the plant from the criterion, as a share; above 0 where the plant stays stable
  /// (or passive) beyond the criterion.
  [[nodiscard]] double off() const noexcept {
    return expected != 0 ? measured / expected - 1 : measured;
  }
};

}  // namespace spm::stability
