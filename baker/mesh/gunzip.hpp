// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace spm::baker {

/// Whether bytes begin as gzip's do.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// Unpacks gzip, of one or more members. Throws BakeError invalid_input, which names the file and
/// the byte, also where more than 16 GiB come out.
[[nodiscard]] std::string gunzip(const std::string& path, std::string_view bytes);

}  // namespace spm::baker
