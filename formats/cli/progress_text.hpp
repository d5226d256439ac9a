// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace spm::cli {

/// Progress of a stage: when it was first reported, and now.
struct StageProgress {
  double done = 0;     ///< part of the stage, 0 to 1
  double start = 0;    ///< part that was done at the first report
  double seconds = 0;  ///< since the first report
};

/// A progress line: the stage, the part that is done and, once it has run for more than a second,
/// about how long it will still take at the pace so far.
[[nodiscard]] std::string progress_text(std::string_view stage, const StageProgress& progress);

}  // namespace spm::cli
