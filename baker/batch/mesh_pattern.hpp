// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace spm::baker {

/// True where a path has characters of a pattern (`*`, `?` or `[`) and no file has it for a name.
[[nodiscard]] bool is_mesh_pattern(const std::string& folder, const std::string& path);

/// The files that match a pattern, relative to a folder whose own name is taken as it is; in the
/// order of their bytes, whatever the locale.
[[nodiscard]] std::vector<std::string> find_meshes(const std::string& folder,
                                                   const std::string& pattern);

/// A text with `{stem}` and `{folder}` filled in from the path of a mesh. Errors: invalid_input for
/// any other word in braces.
[[nodiscard]] Result<std::string> filled_in(const std::string& text, const std::string& mesh);

}  // namespace spm::baker
