// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "servo/shared/shared_layout.h"

namespace spm::servo {

struct AppNames;

/// The names, paths, borders and causes as applications read them. Names that are too long are cut,
/// paths that are too long left out. Allocates: not for the loop.
[[nodiscard]] std::unique_ptr<spm_shared_info> info_of(const AppNames& names);

}  // namespace spm::servo
