// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace spm::baker {

/// The version of what turns a mesh and options into the bytes of an asset. It is part of every
/// cache key. Raise it with any change after which some mesh bakes to other bytes, or a report of
/// `build` says other things; not for what only makes a bake faster. Where the file's format
/// changes, asset_format_version does the same. tests/baker/pipeline/algorithm_version_test.cpp
/// fails when a few small bakes change without it.
inline constexpr int algorithm_version = 16;

}  // namespace spm::baker
