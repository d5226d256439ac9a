// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace spm::baker {

/// Whether bytes begin as gzip's do.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// Unpacks gzip, of one or more members. Throws BakeError invalid_input, which names the file and
/// the byte, also where more than 4 GiB come out,
/// or more than 64 MiB that are 100 times as large as what they came from.
[[nodiscard]] std::string gunzip(const std::string& path, std::string_view bytes);

}  // namespace spm::baker
