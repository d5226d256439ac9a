// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/global_control.h>
#include <tbb/info.h>

namespace spm::bench {

/// During its lifetime, parallel work uses this many threads; 0: as many as there are cores.
[[nodiscard]] inline tbb::global_control thread_limit(unsigned threads) {
  return {tbb::global_control::max_allowed_parallelism,
          threads > 0 ? threads : static_cast<unsigned>(tbb::info::default_concurrency())};
}

}  // namespace spm::bench
