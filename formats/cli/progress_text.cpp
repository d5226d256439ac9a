// SPDX-License-Identifier: Apache-2.0
#include "formats/cli/progress_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace spm::cli {
namespace {

/// Below this time, s, the pace is not reliable.
constexpr double min_seconds = 1;

/// In the largest unit that gives at least 1: an estimate is not precise enough for more digits.
std::string about(double seconds) {
  constexpr double minute = 60, hour = 3600;
  constexpr double max_of_a_unit = 100;
  if (seconds < max_of_a_unit) return fmt::format("{:.0f} s", std::max(1.0, std::ceil(seconds)));
  if (seconds < max_of_a_unit * minute) return fmt::format("{:.0f} min", seconds / minute);
  return fmt::format("{:.0f} h", seconds / hour);
}

}  // namespace

std::string progress_text(std::string_view stage, const StageProgress& progress) {
  const double done = std::clamp(progress.done, 0.0, 1.0);
  std::string text = fmt::format("{} {:3.0f} %", stage, 100 * done);
  const double gained = done - progress.start;
  if (progress.seconds > min_seconds && gained > 0 && done < 1) {
    text += fmt::format(", about {} left", about(progress.seconds * (1 - done) / gained));
  }
  return text;
}

}  // namespace spm::cli
