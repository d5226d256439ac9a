// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/base/error.hpp"

namespace spm::servo {

/// The id of a user or of a group, given by its name or as a number. Errors: usage, for one that
/// this machine does not know.
[[nodiscard]] Result<std::uint32_t> user_id(const std::string& text);
[[nodiscard]] Result<std::uint32_t> group_id(const std::string& text);

}  // namespace spm::servo
