// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/error.hpp"

namespace spm {

/// Reads a text file whole. `wanted` names what it should be, for messages ("a manifest"). Errors:
/// file_or_device, a folder, a missing or an unreadable file, with the cure.
[[nodiscard]] Result<std::string> read_text_file(const std::string& path,
                                                 const std::string& wanted);

}  // namespace spm
