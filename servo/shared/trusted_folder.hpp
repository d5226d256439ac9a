// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>

namespace spm::servo {

/// Whether somebody else could put something of his own in the place of what lies in a folder.
/// Empty if nobody can; otherwise what is wrong and what to do, a sentence that begins with the
/// folder's or a parent's path and has no full stop. The folder and its parents must belong to this
/// user, to root or to `other` (0: nobody else), and be closed to writing by others, who may write
/// to parents with the sticky bit alone. The folder itself is no link, and no link on the way to it
/// is another user's. A folder that does not exist is not to be blamed: it gives an empty text.
[[nodiscard]] std::string distrust_of(const std::string& folder, uid_t other = 0);

/// The folder in which a file lies: "." for a name alone.
[[nodiscard]] std::string folder_of(const std::string& path);

}  // namespace spm::servo
