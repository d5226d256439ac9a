// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "baker/mesh/mesh.hpp"
#include "common/asset/asset_view.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Order statistics of an absolute error.
struct ErrorSummary {
  double rms = 0, p50 = 0, p99 = 0, p999 = 0, max = 0;
};

/// Results at the places where an asset is likeliest wrong; see adversarial_place.
struct AdversarialReport {
  std::uint64_t samples = 0;
  ErrorSummary distance;                                                ///< m
  double inside_as_outside = 0, outside_as_inside = 0, unanswered = 0;  ///< shares, as below
  Vector3 worst_point = Vector3::Zero();
};

struct VerifyReport {
  ErrorSummary distance;                                           ///< m
  double direction_p50 = 0, direction_p99 = 0, direction_max = 0;  ///< rad
  double direction_contested = 0;  ///< share of the samples left out of the directions
  double inside_as_outside = 0;    ///< share of the samples farther than the tolerance
  double outside_as_inside = 0;    ///< likewise
  double unanswered = 0;           ///< share of all samples; `pruned` is no part of it
  double pruned = 0;               ///< share of all samples that lie where the bake left out
  double near_holes = 0;        ///< share of the drawn places that were left out near border edges
  double fallback_answers = 0;  ///< share of the answers that came from triangles
  /// Only for an asset of a smoothed surface, against which all else is judged: how far the
  /// distance to the unsmoothed surface is from that to the smoothed one, and from the answer, m.
  std::optional<ErrorSummary> smoothing, total;
  std::uint64_t samples = 0;
  AdversarialReport adversarial;          ///< of half as many places again
  Band band;                              ///< the band that was sampled
  Vector3 worst_point = Vector3::Zero();  ///< where the distance error is largest, asset's frame
};

struct VerifyOptions {
  std::uint64_t samples = 1'000'000;
  std::uint64_t seed = 1;
  std::optional<double> band;  ///< m inside; default and at most the asset's max_depth
  unsigned threads = 0;        ///< 0: as many as there are cores; never changes the result
};

/// The mesh that an asset was baked from, in the asset's frame. Throws BakeError invalid_input
/// where the file is another one.
[[nodiscard]] Mesh mesh_of_asset(const AssetMetadata& metadata, const std::string& mesh_path);

/// Compares an asset's answers with the exact surface of the mesh file. Closest points are on the
/// outer union of the mesh's parts (CGAL), and sides come from the generalised winding number. No
/// code is shared with the fit. Samples are uniform by area, at uniform depths from `band` inside
/// to the margin outside. Where the bake smoothed the surface, this does too, and compares with
/// both. The mesh is read anew from `mesh_path` with the unit and scale that the asset recorded.
/// Throws BakeError invalid_input where the mesh's hash is not the asset's or the band is too wide.
[[nodiscard]] VerifyReport verify_asset(const AssetView& view, const AssetMetadata& metadata,
                                        const std::string& mesh_path, const VerifyOptions& options);

/// The same against a mesh in memory, which must be in the asset's frame. `unsmoothed` is the mesh
/// before smoothing, or null where it was not smoothed.
///
/// The true distance of a sample lies in the band. At the two ends of the band an answer is a
/// bound: `deep` counts as -max_depth. `far` counts as the margin where that is within the
/// tolerance of the truth, and as no answer elsewhere. A sample is drawn again where its closest
/// point is within 3 % of the diagonal of a border edge, since the side is not defined beside a
/// hole. Directions are judged where they are defined: 2 um or more from the surface, and farther
/// than two tolerances from the medial axis. Without a tolerance, a thousandth of the diagonal
/// takes its place.
[[nodiscard]] VerifyReport verify_against(const Mesh& mesh, const AssetView& view,
                                          const AssetMetadata& metadata,
                                          const VerifyOptions& options,
                                          const Mesh* unsmoothed = nullptr);

}  // namespace spm::baker
