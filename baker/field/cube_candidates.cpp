// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/cube_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
  candidate.closest = closest_on_triangle(point, corners[0], corners[1], corners[2]);
  candidate.distance = (point - candidate.closest).norm();
  return candidate;
}

bool nearer(const Candidate& a, const Candidate& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
}

/// Removes from `open` what one of the witnesses is nearer than in all of the cube.
void remove_covered(const Cube& cube, const std::vector<Witness>& nearest,
                    std::vector<Candidate>& open) {
  std::erase_if(open, [&](const Candidate& candidate) {
    const Vector3 rise = cube.half * tangent_of(candidate, cube.middle);
    return std::any_of(nearest.begin(), nearest.end(), [&](const Witness& witness) {
      return candidate.triangle != witness.triangle &&
             is_everywhere_above(candidate.distance - slack, rise, witness.distances);
    });
  });
}

void narrow(const LatticeSurface& surface, const Cube& cube, Candidates& found) {
  std::sort(found.triangles.begin(), found.triangles.end(), nearer);
  std::sort(found.caps.begin(), found.caps.end(), nearer);
  const double span = 2 * cube.radius() + slack;
  const double nearest = found.distance(), clearance = found.clearance();
  std::erase_if(found.triangles, [&](const Candidate& c) { return c.distance > nearest + span; });
  std::erase_if(found.caps, [&](const Candidate& c) { return c.distance > clearance + span; });
  if (found.triangles.size() + found.caps.size() <= few) return;
  for (std::size_t w = 0; w < std::min(witnesses, found.triangles.size()); ++w) {
    const std::uint32_t triangle = found.triangles[w].triangle;
    found.witnesses.push_back(
        {triangle, corner_distances(surface.triangles[triangle].corners, cube.middle, cube.half)});
  }
  remove_covered(cube, found.witnesses, found.triangles);
  remove_covered(cube, found.witnesses, found.caps);
}

/// Adds those of `around` that may be near enough to a place of the cube. `nearest` is the least
/// distance so far.
void add_near(const LatticeSurface& surface, const std::vector<Candidate>& around,
              const Vector3& middle_around, const Cube& cube, double& nearest,
              std::vector<Candidate>& found) {
  const double span = 2 * cube.radius() + 2 * slack;
  const Vector3 way = cube.middle - middle_around;
  found.reserve(around.size());
  for (const Candidate& candidate : around) {
    const double least = candidate.distance + tangent_of(candidate, middle_around).dot(way);
    if (least > nearest + span) continue;
    found.push_back(seen_from(surface, candidate.triangle, cube.middle));
    nearest = std::min(nearest, found.back().distance);
  }
}

}  // namespace

Vector3 tangent_of(const Candidate& candidate, const Vector3& middle) noexcept {
  if (!(candidate.distance > 0)) return Vector3::Zero();
  return (middle - candidate.closest) / candidate.distance;
}

double Cube::radius() const noexcept { return std::sqrt(3.0) * half; }

Cube Cube::octant(std::size_t octant) const noexcept {
  return {middle + half / 2 * octant_direction(octant), half / 2};
}

double Candidates::distance() const noexcept {
  return triangles.empty() ? std::numeric_limits<double>::infinity() : triangles.front().distance;
}

double Candidates::clearance() const noexcept {
  return caps.empty() ? distance() : std::min(distance(), caps.front().distance);
}

Candidates candidates_within(const LatticeSurface& surface, const Candidates& around,
                             const Cube& cube) {
  Candidates found;
  found.middle = cube.middle;
  double nearest = std::numeric_limits<double>::infinity();
  add_near(surface, around.triangles, around.middle, cube, nearest, found.triangles);
  add_near(surface, around.caps, around.middle, cube, nearest, found.caps);
  narrow(surface, cube, found);
  return found;
}

Candidates candidates_of(const LatticeSurface& surface, const std::vector<std::uint32_t>& triangles,
                         const Cube& cube) {
  Candidates found;
  found.middle = cube.middle;
  for (const std::uint32_t triangle : triangles) {
    auto& kind = surface.triangles[triangle].cap ? found.caps : found.triangles;
    kind.push_back(seen_from(surface, triangle, cube.middle));
  }
  narrow(surface, cube, found);
  return found;
}

Candidates nearest_in_parts(const LatticeSurface& surface, const Candidates& candidates,
                            const Cube& cube, int levels) {
  std::vector<std::uint32_t> kept;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    const Cube part = cube.octant(octant);
    Candidates within = candidates_within(surface, candidates, part);
    if (levels > 1) within = nearest_in_parts(surface, within, part, levels - 1);
    for (const auto* kind : {&within.triangles, &within.caps}) {
      for (const Candidate& candidate : *kind) kept.push_back(candidate.triangle);
    }
  }
  std::sort(kept.begin(), kept.end());
  Candidates found = candidates;
  const auto gone = [&kept](const Candidate& candidate) {
    return !std::binary_search(kept.begin(), kept.end(), candidate.triangle);
  };
  std::erase_if(found.triangles, gone);
  std::erase_if(found.caps, gone);
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

bool NearestPart::is_inside(const Caster& caster, const Vector3& point) const {
  if (triangle == nullptr) return false;
  if (triangle->open) return caster.closest(point).distance < 0;
  return spm::is_inside(triangle->sides, closest.feature,
                        triangle->normal.dot(point - closest.point));
}

bool is_inside(const LatticeSurface& surface, const Caster& caster, const Candidates& candidates,
               const Vector3& point) {
  NearestPart nearest;
  for (const auto* kind : {&candidates.triangles, &candidates.caps}) {
    for (const Candidate& candidate : *kind) {
      nearest.meet(surface.triangles[candidate.triangle], point);
    }
  }
  return nearest.is_inside(caster, point);
}

}  // namespace spm::baker
