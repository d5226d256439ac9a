// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>

#include "common/asset/asset_view.hpp"
#include "tests/bench/methods/mesh_proxy.hpp"
#include "tests/bench/methods/tick_timing.hpp"
#include "tests/bench/model/query_asset.hpp"

namespace spm::bench {

// Forces along a path, with a stiffness of 1000 N/m. The arguments must outlive the methods. The
// "given" methods already have the search results, one per tick of `path`, and count the ticks in
// contact. They give the figures without collision detection in the tables.

[[nodiscard]] std::unique_ptr<TickMethod> proxy_ticks(MeshProxy& proxy);
[[nodiscard]] std::unique_ptr<TickMethod> proxy_ticks_given(MeshProxy& proxy,
                                                            std::span<const Vector3> path);

/// The paper's rule, which takes the closest plane, and its force (eq. 9).
[[nodiscard]] std::unique_ptr<TickMethod> paper_ticks(const AssetView& asset);
[[nodiscard]] std::unique_ptr<TickMethod> paper_ticks_given(const AssetView& asset,
                                                            std::span<const Vector3> path);

/// spm_query_force; `radius` in metres, 0 is a point.
[[nodiscard]] std::unique_ptr<TickMethod> spm_ticks(const spm_query_asset& asset, double radius);

/// The product's own proxy, as the servo's loop asks it, without effects; `radius` as above. It is
/// not known where it begins: each pass starts it anew.
[[nodiscard]] std::unique_ptr<TickMethod> own_proxy_ticks(const AssetView& asset, double radius);

}  // namespace spm::bench
