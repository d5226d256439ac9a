// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/query/query.hpp"

namespace spm {

/// query_point of a `sparse` asset, before the band's ends are applied: one look-up in the octree,
/// then a polynomial or a short list of exact triangles.
[[nodiscard]] Answer query_octree(const AssetView& asset, const Vector3& point) noexcept;
/// The same where the leaf around the point is known.
[[nodiscard]] Answer query_leaf(const AssetView& asset, const Leaf& leaf,
                                const Vector3& point) noexcept;

}  // namespace spm
