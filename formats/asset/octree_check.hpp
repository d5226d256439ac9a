// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "common/asset/asset_view.hpp"

namespace spm {

/// What is wrong with the octree and the triangles of a `sparse` asset; empty where nothing is. In
/// time that grows with their words and no faster, whatever these are: `steps`, where given, is set
/// to the number of cubes, listed triangles and triangles that were looked at.
[[nodiscard]] std::string octree_problem(const AssetView& asset, std::size_t* steps = nullptr);

}  // namespace spm
