// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace spm::bench {

/// How the figures were made, for the key `made` of a report: `machine` (processor, cores, memory,
/// system, kernel, compiler, libraries) and `command` (this process's own, paths without their
/// folders). Nothing that names the machine, its user or its folders.
[[nodiscard]] nlohmann::ordered_json made_json();

}  // namespace spm::bench
