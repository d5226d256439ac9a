// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/cube_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "common/base/octant.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// So many of the nearest triangles are tried as the one that is nearer in all of the cube.
constexpr std::size_t witnesses = 4;
/// Fewer candidates than this are not worth a second look.
constexpr std::size_t few = 6;
/// Of distances, so that the rounding of doubles leaves none out.
constexpr double slack = 1e-12;

Candidate seen_from(const LatticeSurface& surface, std::uint32_t triangle, const Vector3& point) {
  const auto& corners = surface.triangles[triangle].corners;
  Candidate candidate;
  candidate.triangle = triangle;
  const Vector3 away = point - closest_on_triangle(point, corners[0], corners[1], corners[2]);
  candidate.distance = away.norm();
  if (candidate.distance > 0) candidate.tangent = away / candidate.distance;
  return candidate;
}

/// A function object, which sorting calls at no cost.
constexpr auto nearer = [](const Candidate& a, const Candidate& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
};

/// What may be near enough to a place of a cube. Most of it is not, so few are kept.
struct Near {
  std::vector<Candidate> solids, sheets;
  void clear() {
    solids.clear();
    sheets.clear();
  }
};

double least_distance(const std::vector<Candidate>& from) {
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : from) least = std::min(least, candidate.distance);
  return least;
}

std::size_t count_within(const std::vector<Candidate>& from, double most) {
  return static_cast<std::size_t>(std::count_if(
      from.begin(), from.end(), [&](const Candidate& c) { return c.distance <= most; }));
}

void find_witnesses(const LatticeSurface& surface, const Cube& cube,
                    const std::vector<Candidate>& from, double most, CandidatesOfKind& found) {
  std::array<Candidate, witnesses> first;
  const auto last =
      std::partial_sort_copy(from.begin(), from.end(), first.begin(), first.end(), nearer);
  for (auto one = first.begin(); one != last && one->distance <= most; ++one) {
    found.witnesses.push_back(
        {one->triangle,
         corner_distances(surface.triangles[one->triangle].corners, cube.middle, cube.half)});
  }
}

/// Keeps those no farther than `most`, but for what witnesses cover: where a witness is nearer in
/// all of the cube, its distances at the corners are below the tangent. None is below its own.
void keep_near(const Cube& cube, const std::vector<Candidate>& from, double most,
               std::span<const CornerValues> distances, std::vector<Candidate>& to) {
  thread_local std::vector<Candidate> tried;
  thread_local std::vector<LinearFunction> tangents;
  thread_local std::vector<std::uint8_t> covered;
  tried.clear();
  tangents.clear();
  for (const Candidate& candidate : from) {
    if (candidate.distance > most) continue;
    tried.push_back(candidate);
    tangents.push_back({candidate.distance - slack, cube.half * candidate.tangent});
  }
  find_above(tangents, distances, covered);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (covered[i] == 0) to.push_back(tried[i]);
  }
  std::sort(to.begin(), to.end(), nearer);
}

Candidates narrowed(const LatticeSurface& surface, const Cube& cube, const Near& near) {
  const double span = 2 * cube.radius() + slack;
  double solid = least_distance(near.solids);
  const double sheet = least_distance(near.sheets);
  // No sheet lies inside a solid but by rounding, so where one is nearer than all solids it is
  // outside, and alone is felt.
  const bool sheets_only = solid > sheet + span + 2 * surface.displacement;
  if (sheets_only) solid = std::numeric_limits<double>::infinity();
  const double most_solid = sheets_only ? -1 : solid + span;
  const double most_sheet = std::min(sheet, solid + surface.sheet_thickness) + span;
  Candidates found;
  const std::size_t count =
      count_within(near.solids, most_solid) + count_within(near.sheets, most_sheet);
  if (count > few) {
    find_witnesses(surface, cube, near.solids, most_solid, found.solids);
    find_witnesses(surface, cube, near.sheets, most_sheet, found.sheets);
  }
  std::vector<CornerValues> distances;
  for (const Witness& witness : found.solids.witnesses) distances.push_back(witness.distances);
  keep_near(cube, near.solids, most_solid, distances, found.solids.triangles);
  for (CornerValues& values : distances) values += surface.sheet_thickness;
  for (const Witness& witness : found.sheets.witnesses) distances.push_back(witness.distances);
  keep_near(cube, near.sheets, most_sheet, distances, found.sheets.triangles);
  return found;
}

/// Adds those of `around` that may be near enough to a place of an octant, to each of the eight.
void add_near(const LatticeSurface& surface, const std::vector<Candidate>& around, const Cube& cube,
              std::vector<Candidate> Near::*kind, std::array<double, 8>& nearest,
              std::array<Near, 8>& found) {
  const double span = cube.radius() + 2 * slack;
  for (const Candidate& candidate : around) {
    // The middles of the octants are the corners of a cube of half the edge.
    const CornerVectors seen =
        corner_vectors(surface.triangles[candidate.triangle].corners, cube.middle, cube.half / 2);
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const auto k = static_cast<Eigen::Index>(octant);
      const double distance = seen.distances[k];
      if (distance > nearest[octant] + span) continue;
      nearest[octant] = std::min(nearest[octant], distance);
      const double per = distance > 0 ? 1 / distance : 0;
      (found[octant].*kind)
          .push_back({candidate.triangle, distance,
                      per * Vector3(seen.away[0][k], seen.away[1][k], seen.away[2][k])});
    }
  }
}

}  // namespace

double Cube::radius() const noexcept { return std::sqrt(3.0) * half; }

Cube Cube::octant(std::size_t octant) const noexcept {
  return {middle + half / 2 * octant_direction(octant), half / 2};
}

double CandidatesOfKind::distance() const noexcept {
  return triangles.empty() ? std::numeric_limits<double>::infinity() : triangles.front().distance;
}

double felt_nearer(const LatticeSurface& surface, const Candidates& candidates) noexcept {
  return candidates.sheets.triangles.empty() ? 0 : surface.sheet_thickness;
}

std::array<Candidates, 8> candidates_in_octants(const LatticeSurface& surface,
                                                const Candidates& around, const Cube& cube) {
  // Kept from cube to cube, since to allocate it each time takes longer than to fill it.
  thread_local std::array<Near, 8> near;
  for (Near& octant : near) octant.clear();
  std::array<double, 8> nearest;
  nearest.fill(std::numeric_limits<double>::infinity());
  add_near(surface, around.solids.triangles, cube, &Near::solids, nearest, near);
  for (double& distance : nearest) distance += surface.sheet_thickness;
  add_near(surface, around.sheets.triangles, cube, &Near::sheets, nearest, near);
  std::array<Candidates, 8> found;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    found[octant] = narrowed(surface, cube.octant(octant), near[octant]);
  }
  return found;
}

Candidates candidates_of(const LatticeSurface& surface, const std::vector<std::uint32_t>& triangles,
                         const Cube& cube) {
  Near near;
  for (const std::uint32_t triangle : triangles) {
    auto& kind = surface.triangles[triangle].sheet ? near.sheets : near.solids;
    kind.push_back(seen_from(surface, triangle, cube.middle));
  }
  return narrowed(surface, cube, near);
}

Candidates nearest_in_parts(const LatticeSurface& surface, const Candidates& candidates,
                            const Cube& cube, int levels) {
  std::vector<std::uint32_t> kept;
  std::array<Candidates, 8> octants = candidates_in_octants(surface, candidates, cube);
  for (std::size_t octant = 0; octant < 8; ++octant) {
    Candidates& within = octants[octant];
    if (levels > 1) {
      within = nearest_in_parts(surface, within, cube.octant(octant), levels - 1);
    }
    for (const auto* kind : {&within.solids, &within.sheets}) {
      for (const Candidate& candidate : kind->triangles) kept.push_back(candidate.triangle);
    }
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    if (kept.size() == candidates.size()) return candidates;
  }
  Candidates found = candidates;
  const auto gone = [&kept](const Candidate& candidate) {
    return !std::binary_search(kept.begin(), kept.end(), candidate.triangle);
  };
  std::erase_if(found.solids.triangles, gone);
  std::erase_if(found.sheets.triangles, gone);
  return found;
}

void NearestPart::meet(const LatticeTriangle& other, const Vector3& point) {
  const ClosestFeature here =
      closest_feature(point, other.corners[0], other.corners[1], other.corners[2]);
  const double away = (point - here.point).norm();
  if (away >= distance) return;
  distance = away;
  closest = here;
  triangle = &other;
}

bool NearestPart::is_inside(const LatticeSurface& surface, const Vector3& point) const {
  if (triangle == nullptr) return false;
  const double along = along_normal(triangle->normal, point - closest.point);
  const std::optional<bool> told = side_told(triangle->sides, closest.feature, along,
                                             triangle->corners, closest.point, distance * distance);
  return told ? *told : surface.caster->surrounds(point, distance);
}

bool is_middle_inside(const LatticeSurface& surface, const Candidates& candidates,
                      const Cube& cube) {
  NearestPart nearest;
  for (const Candidate& candidate : candidates.solids.triangles) {
    if (candidate.distance - slack > nearest.distance) break;
    nearest.meet(surface.triangles[candidate.triangle], cube.middle);
  }
  return nearest.is_inside(surface, cube.middle);
}

}  // namespace spm::baker
