// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "baker/build/build.hpp"
#include "baker/cache/cache.hpp"

namespace spm::baker {

/// run_build through a cache, or without one where `cache` is null. The report has the same keys,
/// and `cache` (`hit`, `miss` or `off`) and `cache_reason`. A hit writes the bytes that a bake
/// would write, and leaves an output alone that has them already. An entry that is not whole is
/// removed, with a warning, and baked again. A cache that cannot be written costs a warning and no
/// bake.
[[nodiscard]] BuildReport build_through(const Cache* cache, const BuildRequest& request,
                                        const Progress& progress);

/// Whether a build would be a hit, and why not; nothing is written. For rehearsals.
struct CacheForecast {
  bool hit = false;
  std::string reason;
};
[[nodiscard]] CacheForecast forecast(const Cache& cache, const BuildRequest& request);

}  // namespace spm::baker
