// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/base/error.hpp"

namespace spm::cli {

/// Reads a number of bytes with its unit: B, kB, MB, GB, TB, or KiB, MiB, GiB, TiB. Errors: usage,
/// for a bare number and anything else.
[[nodiscard]] Result<std::uint64_t> parse_byte_size(const std::string& text);

}  // namespace spm::cli
