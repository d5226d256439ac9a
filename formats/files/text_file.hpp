// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/error.hpp"

namespace spm {

/// Reads a whole text file. `wanted` names what it should be, for messages ("a manifest"). Errors:
/// file_or_device for a folder, a missing or an unreadable file, with the remedy.
[[nodiscard]] Result<std::string> read_text_file(const std::string& path,
                                                 const std::string& wanted);

/// Whether a path leads to a device, a pipe or a socket, which may never end.
[[nodiscard]] bool is_special_file(const std::string& path);

/// The same for a file that another file names: nothing special is read. Errors: file_or_device.
[[nodiscard]] Result<std::string> read_regular_file(const std::string& path,
                                                    const std::string& wanted);

}  // namespace spm
