// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace spm::cli {

/// How far a stage was when it was first heard of, and is now.
struct StageProgress {
  double done = 0;     ///< share of the stage, 0 to 1
  double start = 0;    ///< share that was done when it was first heard of
  double seconds = 0;  ///< since then
};

/// A progress line: the stage, its share done and, once it has been going for more than a second,
/// about how long it still takes at the pace so far.
[[nodiscard]] std::string progress_text(std::string_view stage, const StageProgress& progress);

}  // namespace spm::cli
