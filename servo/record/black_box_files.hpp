// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <ctime>
#include <string>

#include "common/base/error.hpp"
#include "servo/record/black_box_memory.hpp"

namespace spm::servo {

/// How many files of a pattern are kept.
inline constexpr std::size_t black_boxes_kept = 5;

/// Where black boxes are written by default: a file for each, with the daemon's name and the time,
/// in the user's folder for program state. `name`: of the daemon; empty: the default one's. Empty
/// if there is no such folder.
[[nodiscard]] std::string default_black_box(const std::string& name = {});

/// The file for a black box that is written at a time. `pattern`: a path; where its file name has
/// a `*`, the time in UTC stands there, and after it a number if there is such a file already.
[[nodiscard]] std::string black_box_file(const std::string& pattern, std::time_t now);

/// Writes a black box to the file of now, and of the files of the pattern removes the oldest, so
/// that black_boxes_kept are left. Returns the file's path. Errors: file_or_device.
[[nodiscard]] Result<std::string> write_black_box(const BlackBoxMemory& memory,
                                                  const std::string& pattern,
                                                  std::time_t now = std::time(nullptr));

}  // namespace spm::servo
