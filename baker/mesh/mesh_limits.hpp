// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace spm::baker {

/// The most vertices that a file may place, and the most triangles: many parts of it may name the
/// same few bytes.
inline constexpr std::size_t most_points = std::size_t{1} << 25U;

/// A mesh packs by a factor of 3 to 20. What unpacks to more than so many times as many bytes, and
/// to more bytes than these, is none.
inline constexpr std::size_t most_growth = 100, always_unpacked = std::size_t{64} << 20U;

}  // namespace spm::baker
