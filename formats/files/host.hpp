// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <string>

#include "common/base/error.hpp"

namespace spm {

/// What reading a file's words in place asks of a machine.
struct Host {
  std::endian order = std::endian::native;
  std::size_t address_bits = 8 * sizeof(void*);
};

/// Refuses machines that cannot read or write a file of ours: its words are used as they lie, in
/// little-endian order, at addresses of 64 bits. Errors: unsupported, with one sentence about
/// `path`.
[[nodiscard]] Result<void> check_host(const std::string& path, const Host& host = {});

}  // namespace spm
