// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace spm::servo {

/// How well something suits a loop at 1 kHz.
enum class Verdict : std::uint8_t { good, fair, poor, unknown };

[[nodiscard]] inline const char* to_string(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::good:
      return "good";
    case Verdict::fair:
      return "fair";
    case Verdict::poor:
      return "poor";
    case Verdict::unknown:
      break;
  }
  return "unknown";
}

/// One result of `doctor`.
struct Check {
  std::string name;  ///< part of the contract
  Verdict verdict = Verdict::unknown;
  std::string measured;  ///< what was found, a clause
  std::string cure;      ///< what to do, a sentence; empty if there is nothing to do
};

}  // namespace spm::servo
