// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "baker/mesh/mesh.hpp"
#include "baker/surface/outer_surface.hpp"
#include "baker/verify/verify.hpp"
#include "common/asset/asset_view.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// A mesh of more triangles is not drawn: the page would be too large to open.
inline constexpr std::size_t most_drawn_triangles = 400'000;

/// The outer surface of the mesh with the asset's error at each vertex, see largest_error_at, as
/// the page draws it. Each list is deflated, then in base64: `positions`, three a vertex, whole
/// steps of `step_m` from `origin_m`, as integers of 16 bits; `triangles`, three corners each, as
/// integers of 32 bits, each the difference to the one before; of both all lowest bytes come first,
/// then the next. `errors` (um; -1: none was told) as floats of 32 bits. `scale_um` is the end of
/// the colours. Where there are too many triangles only `left_out`, a sentence.
[[nodiscard]] nlohmann::ordered_json surface_json(const Mesh& mesh, const AssetView& view,
                                                  const AssetMetadata& metadata,
                                                  const VerifyReport& report);

}  // namespace spm::baker
