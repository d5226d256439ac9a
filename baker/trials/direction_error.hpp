// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/cast/cast.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// How far an asset's directions are off in the median, rad, at places of its band where the
/// surface is nearest in one direction: a finished tree of elements and a space are needed. 0 where
/// no place can be tried.
[[nodiscard]] double median_direction_error(const Asset& asset, const Caster& caster,
                                            std::uint64_t seed);

}  // namespace spm::baker
