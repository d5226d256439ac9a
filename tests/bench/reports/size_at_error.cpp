// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/size_at_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace spm::bench {

std::optional<SizeAtError> size_at_error(std::vector<SizeAndError> settings, double error,
                                         double exact) {
  std::sort(settings.begin(), settings.end(),
            [](const SizeAndError& a, const SizeAndError& b) { return a.bytes < b.bytes; });
  const auto free_of_error =
      std::find_if(settings.begin(), settings.end(),
                   [exact](const SizeAndError& setting) { return setting.error < exact; });
  if (free_of_error != settings.end()) return SizeAtError{free_of_error->bytes};
  if (settings.size() < 2) return std::nullopt;
  // The first pair whose end is good enough, or else the last pair.
  std::size_t end = 1;
  while (end + 1 < settings.size() && settings[end].error > error) ++end;
  const SizeAndError& coarse = settings[end - 1];
  const SizeAndError& fine = settings[end];
  if (!(fine.error < coarse.error) || !(fine.bytes > coarse.bytes)) return std::nullopt;
  SizeAtError result;
  result.slope = std::log(fine.bytes / coarse.bytes) / std::log(fine.error / coarse.error);
  result.bytes = fine.bytes * std::pow(error / fine.error, result.slope);
  const bool between = error <= coarse.error && error >= fine.error;
  result.estimate = between ? Estimate::interpolated : Estimate::extrapolated;
  return result;
}

const char* to_string(Estimate estimate) noexcept {
  switch (estimate) {
    case Estimate::measured:
      return "measured";
    case Estimate::interpolated:
      return "interpolated";
    case Estimate::extrapolated:
      return "extrapolated";
  }
  return "measured";
}

}  // namespace spm::bench
