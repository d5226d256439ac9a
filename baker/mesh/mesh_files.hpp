// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace spm::baker {

/// The extension by which a mesh file is read, in lower case; with that of gzip (".obj.gz").
[[nodiscard]] std::string mesh_extension(const std::string& path);

/// The extension of what is in a mesh file, without that of gzip (".obj").
[[nodiscard]] std::string unpacked_extension(const std::string& path);

/// Whether files of this format say themselves what their numbers are.
[[nodiscard]] bool names_unit(const std::string& path);

/// The other files that a mesh is made of: buffers that a glTF names. None where the file cannot be
/// read or is broken, which its bake will tell. `outside_buffers`: as of LoadOptions.
[[nodiscard]] std::vector<std::string> mesh_companions(const std::string& path,
                                                       bool outside_buffers);

/// What tells a mesh from any other: the SHA-256 of its file's bytes, or, where it is made of
/// several files, that of their digests as text. Errors: file_or_device.
[[nodiscard]] Result<std::string> mesh_sha256(const std::string& path, bool outside_buffers);

/// The same from digests that are known already.
[[nodiscard]] std::string mesh_sha256(const std::string& digest,
                                      const std::vector<std::string>& companion_digests);

}  // namespace spm::baker
