// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace spm {

/// SHA-256 of bytes in memory: 64 lower-case hex digits (FIPS 180-4).
[[nodiscard]] std::string sha256_bytes(std::span<const std::byte> bytes);
[[nodiscard]] std::string sha256_bytes(std::string_view bytes);

/// SHA-256 of a file's bytes: 64 lower-case hex digits. Errors: file_or_device.
[[nodiscard]] Result<std::string> sha256_file(const std::string& path);

}  // namespace spm
