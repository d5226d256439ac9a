// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace spm::bench {

/// What the figures were measured on: processor, cores, memory, system, compiler, libraries.
/// Nothing that names the machine, its user or its folders.
[[nodiscard]] nlohmann::ordered_json machine_json();

}  // namespace spm::bench
