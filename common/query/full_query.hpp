// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/query/query.hpp"

namespace spm {

/// query_point on a `full` asset, except that the end of the band is not applied.
[[nodiscard]] Answer query_full(const AssetView& asset, const Vector3& point) noexcept;

}  // namespace spm
