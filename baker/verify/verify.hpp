// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/mesh/mesh.hpp"
#include "common/asset/asset_view.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// Order statistics of an absolute error.
struct ErrorSummary {
  double rms = 0, p50 = 0, p99 = 0, p999 = 0, max = 0;
};

/// What is wrong at a place, the gravest first.
enum class Finding : std::uint8_t { unanswered, wrong_side, beyond_tolerance, within };

/// The finding in the words of the JSON, such as "wrong_side".
[[nodiscard]] const char* name_of(Finding finding) noexcept;

/// How many places break the promise, by what is wrong there. Some count twice: an answer on the
/// wrong side is beyond the tolerance too, and `far` inside has no answer and is on the wrong side.
struct Counts {
  std::uint64_t unanswered = 0;
  std::uint64_t wrong_side = 0;        ///< only where the surface is farther than the tolerance
  std::uint64_t beyond_tolerance = 0;  ///< answers whose distance is off by more
  std::uint64_t pruned = 0;            ///< left out by the bake; not judged, breaks nothing
  std::uint64_t doubtful_gaps = 0;     ///< right with a doubtful gap open, closed or in between

  /// Places where anything is wrong, each once.
  [[nodiscard]] std::uint64_t missed() const noexcept { return unanswered + beyond_tolerance; }
};

/// One of the places where an asset is worst.
struct WorstPlace {
  Vector3 point = Vector3::Zero();  ///< m, asset's frame
  double truth = 0;                 ///< m, the exact signed distance
  std::optional<double> error;      ///< m, unsigned; nothing where there is no answer
  Finding kind = Finding::within;
  bool hard = false;  ///< of the places of AdversarialReport
};

/// Results at the places where an asset is likeliest wrong; see AdversarialPlaces.
struct AdversarialReport {
  std::uint64_t samples = 0;
  Counts counts;
  ErrorSummary distance;                                                ///< m
  double inside_as_outside = 0, outside_as_inside = 0, unanswered = 0;  ///< shares, as below
  Vector3 worst_point = Vector3::Zero();
};

/// Order statistics of an angle, rad.
struct DirectionSummary {
  double p50 = 0, p99 = 0, max = 0;
};

/// How far answers jump where two leaves of a `sparse` asset's octree meet; see border_jumps.
struct JumpReport {
  std::uint64_t places = 0;               ///< where both sides answered and were compared
  std::uint64_t borders = 0;              ///< pairs of leaves that these lie between
  std::uint64_t contested = 0;            ///< places close to the medial axis
  std::uint64_t beyond = 0;               ///< jumps of the distance above `allowed`
  double allowed = 0;                     ///< m, twice the tolerance and a little
  ErrorSummary distance;                  ///< m
  DirectionSummary direction;             ///< away from the medial axis
  DirectionSummary contested_direction;   ///< close to it, where the true direction jumps
  Vector3 worst_point = Vector3::Zero();  ///< of the largest jump of the distance
};

inline constexpr std::size_t histogram_bins = 40;

struct VerifyReport {
  ErrorSummary distance;  ///< m
  /// Samples by the error of their distance: `histogram_bins` of equal width up to `threshold`, and
  /// one more of all that are larger.
  std::vector<std::uint64_t> histogram;
  double direction_p50 = 0, direction_p99 = 0, direction_max = 0;  ///< rad
  std::uint64_t directions = 0;    ///< how many of the samples these are of
  double direction_contested = 0;  ///< share of these that is left out of them
  /// There, from the nearest of the directions that compete, rad.
  double contested_p50 = 0, contested_p99 = 0, contested_max = 0;
  double inside_as_outside = 0;  ///< share of the samples farther than the tolerance
  double outside_as_inside = 0;  ///< likewise
  double unanswered = 0;         ///< share of all samples; `pruned` is no part of it
  double pruned = 0;             ///< share of all samples that lie where the bake left out
  double not_judged = 0;         ///< share of the samples for which no place in the band was found
  double fallback_answers = 0;   ///< share of the answers that came from triangles
  /// Only for an asset of a smoothed surface, against which all else is judged: how far the
  /// distance to the unsmoothed surface is from that to the smoothed one, and from the answer, m.
  std::optional<ErrorSummary> smoothing, total;
  std::uint64_t samples = 0;
  std::uint64_t seed = 0;           ///< which the places were drawn with
  Counts counts;                    ///< of the samples
  AdversarialReport adversarial;    ///< of half as many places again
  JumpReport jumps;                 ///< at a quarter as many places
  std::vector<WorstPlace> worst;    ///< unanswered first, then by error, largest first
  Band band;                        ///< the band that was sampled
  std::optional<double> tolerance;  ///< m, the promise; nothing where the asset makes none
  bool tolerance_met = false;       ///< as the asset records it
  double threshold = 0;             ///< m, what counts as beyond: the promise, or in its place
  Vector3 worst_point = Vector3::Zero();  ///< where the distance error is largest, asset's frame

  /// Samples and hard places that were judged: all but those that the bake left out.
  [[nodiscard]] std::uint64_t judged() const noexcept;
  /// Samples and hard places where the answer is missing or off by more than the threshold.
  [[nodiscard]] std::uint64_t missed() const noexcept;
  /// False where the promise is missed anywhere, where a jump shows that it is, and where there is
  /// one but no place to judge it at. True for an asset that promises nothing.
  [[nodiscard]] bool passed() const noexcept;
};

struct VerifyOptions {
  std::uint64_t samples = 1'000'000;
  std::uint64_t seed = 1;
  std::optional<double> band;  ///< m inside; default and at most the asset's max_depth
  unsigned threads = 0;        ///< 0: as many as there are cores; never changes the result
  std::size_t worst = 20;      ///< how many of the worst places to list
};

/// The mesh that an asset was baked from, in the asset's frame. Throws BakeError invalid_input
/// where the file is another one.
[[nodiscard]] Mesh mesh_of_asset(const AssetMetadata& metadata, const std::string& mesh_path);

/// Compares an asset's answers with the exact surface of the mesh file. Closest points are on the
/// outer union of the mesh's parts (CGAL), and sides come from exact winding numbers. No
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
/// tolerance of the truth, and as no answer elsewhere. Directions are judged where they are
/// defined: 2 um or more from the surface, and farther than two tolerances from the medial axis.
/// Nearer to that axis they are judged apart, against the nearest of the directions that compete.
/// Whether the bake was right to leave a place out is not judged. Without a tolerance, a thousandth
/// of the diagonal takes its place.
[[nodiscard]] VerifyReport verify_against(const Mesh& mesh, const AssetView& view,
                                          const AssetMetadata& metadata,
                                          const VerifyOptions& options,
                                          const Mesh* unsmoothed = nullptr);

}  // namespace spm::baker
