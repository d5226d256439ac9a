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
constexpr std::size_t most_witnesses = 4;
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

/// Octants that wait to be used again, of each thread so many, each of them with room for so many
/// candidates at most.
constexpr std::size_t most_octants = 512, most_kept = 64;
thread_local std::vector<std::unique_ptr<std::array<CandidateTree, 8>>> kept_octants;

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
                    const std::vector<Candidate>& from, double most, std::vector<Witness>& found) {
  std::array<const Candidate*, most_witnesses + 1> first{};
  std::size_t count = 0;
  for (const Candidate& candidate : from) {
    if (candidate.distance > most) continue;
    std::size_t at = count;
    for (; at > 0 && nearer(candidate, *first[at - 1]); --at) first[at] = first[at - 1];
    first[at] = &candidate;
    count = std::min(count + 1, most_witnesses);
  }
  found.reserve(most_witnesses);
  for (std::size_t i = 0; i < count; ++i) {
    found.push_back({first[i]->triangle, surface.triangles[first[i]->triangle].corner_distances(
                                             cube.middle, cube.half)});
  }
}

/// Keeps those no farther than `most`, but for what witnesses cover: where a witness is nearer
/// in all of the cube, its distances at the corners are below the tangent. None is below its own.
void keep_uncovered(const Cube& cube, const std::vector<Candidate>& from, double most,
                    std::span<const CornerValues> distances, std::vector<Candidate>& kept) {
  thread_local std::vector<const Candidate*> tried;
  thread_local std::vector<LinearFunction> tangents;
  thread_local std::vector<std::uint8_t> covered;
  tried.clear();
  tangents.clear();
  for (const Candidate& candidate : from) {
    if (candidate.distance > most) continue;
    tried.push_back(&candidate);
    tangents.push_back({candidate.distance - slack, cube.half * candidate.tangent});
  }
  find_above(tangents, distances, covered);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (covered[i] == 0) kept.push_back(*tried[i]);
  }
}

/// The candidates of a cube among what may be near enough, and the witnesses that told.
void narrow(const LatticeSurface& surface, const Cube& cube, const Near& near, Candidates& found) {
  const double span = 2 * cube.radius() + slack;
  double solid = least_distance(near.solids);
  const double sheet = least_distance(near.sheets);
  // No sheet lies inside a solid but by rounding, so where one is nearer than all solids it is
  // outside, and alone is felt.
  const bool sheets_only = solid > sheet + span + 2 * surface.displacement;
  if (sheets_only) solid = std::numeric_limits<double>::infinity();
  const double most_solid = sheets_only ? -1 : solid + span;
  const double most_sheet = std::min(sheet, solid + surface.sheet_thickness) + span;
  for (auto* kind : {&found.solids, &found.sheets}) {
    kind->triangles.clear();
    kind->witnesses.clear();
  }
  const std::size_t count =
      count_within(near.solids, most_solid) + count_within(near.sheets, most_sheet);
  if (count > few) {
    find_witnesses(surface, cube, near.solids, most_solid, found.solids.witnesses);
    find_witnesses(surface, cube, near.sheets, most_sheet, found.sheets.witnesses);
  }
  thread_local std::vector<CornerValues> distances;
  distances.clear();
  for (const Witness& witness : found.solids.witnesses) distances.push_back(witness.distances);
  keep_uncovered(cube, near.solids, most_solid, distances, found.solids.triangles);
  for (CornerValues& values : distances) values += surface.sheet_thickness;
  for (const Witness& witness : found.sheets.witnesses) distances.push_back(witness.distances);
  keep_uncovered(cube, near.sheets, most_sheet, distances, found.sheets.triangles);
  for (auto* kind : {&found.solids, &found.sheets}) {
    std::sort(kind->triangles.begin(), kind->triangles.end(), nearer);
  }
}

/// Adds those of `around` that may be near enough to a place of an octant, to each of the eight.
void add_near(const LatticeSurface& surface, const std::vector<Candidate>& around, const Cube& cube,
              std::vector<Candidate> Near::*kind, std::array<double, 8>& nearest,
              std::array<Near, 8>& found) {
  const double span = cube.radius() + 2 * slack;
  for (const Candidate& candidate : around) {
    // The middles of the octants are the corners of a cube of half the edge.
    const CornerTangents seen =
        surface.triangles[candidate.triangle].corner_tangents(cube.middle, cube.half / 2);
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const auto k = static_cast<Eigen::Index>(octant);
      const double distance = seen.distances[k];
      if (distance > nearest[octant] + span) continue;
      nearest[octant] = std::min(nearest[octant], distance);
      (found[octant].*kind)
          .push_back({candidate.triangle,
                      distance,
                      {seen.tangents[0][k], seen.tangents[1][k], seen.tangents[2][k]}});
    }
  }
}

/// What may be near enough to a place of an octant, for each of the eight. It is kept from cube to
/// cube, since to allocate it each time takes longer than to fill it.
const std::array<Near, 8>& near_octants(const LatticeSurface& surface, const Candidates& around,
                                        const Cube& cube) {
  thread_local std::array<Near, 8> near;
  for (Near& octant : near) octant.clear();
  std::array<double, 8> nearest;
  nearest.fill(std::numeric_limits<double>::infinity());
  add_near(surface, around.solids.triangles, cube, &Near::solids, nearest, near);
  for (double& distance : nearest) distance += surface.sheet_thickness;
  add_near(surface, around.sheets.triangles, cube, &Near::sheets, nearest, near);
  return near;
}

/// Whether each of some candidates of one kind is the nearest in the middle of an octant: if so,
/// none is left out of all of them.
bool all_nearest_to_middles(const LatticeSurface& surface, const CandidatesOfKind& candidates,
                            const Cube& cube) {
  if (candidates.triangles.size() > 8) return false;
  std::array<CornerValues, 8> distances;
  CornerValues least = CornerValues::Constant(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < candidates.triangles.size(); ++i) {
    distances[i] = surface.triangles[candidates.triangles[i].triangle].corner_distances(
        cube.middle, cube.half / 2);
    least = least.min(distances[i]);
  }
  for (std::size_t i = 0; i < candidates.triangles.size(); ++i) {
    if (!(distances[i] <= least + slack / 2).any()) return false;
  }
  return true;
}

/// Which of a cube's candidates are candidates of its parts too.
class Kept {
 public:
  explicit Kept(const Candidates& all) {
    each(all, [this](std::uint32_t triangle) { triangles_.push_back(triangle); });
    std::sort(triangles_.begin(), triangles_.end());
    kept_.resize(triangles_.size());
  }
  [[nodiscard]] bool has(std::uint32_t triangle) const { return kept_[place(triangle)]; }
  [[nodiscard]] bool has_all(const Candidates& part) const {
    bool all = true;
    each(part, [&](std::uint32_t triangle) { all = all && has(triangle); });
    return all;
  }
  void add(const Candidates& part) {
    each(part, [this](std::uint32_t triangle) { kept_[place(triangle)] = true; });
  }

 private:
  std::vector<std::uint32_t> triangles_;  ///< in their order
  std::vector<bool> kept_;

  template <class Visit>
  static void each(const Candidates& of, const Visit& visit) {
    for (const auto* kind : {&of.solids, &of.sheets}) {
      for (const Candidate& one : kind->triangles) visit(one.triangle);
    }
  }
  [[nodiscard]] std::size_t place(std::uint32_t triangle) const {
    return static_cast<std::size_t>(
        std::lower_bound(triangles_.begin(), triangles_.end(), triangle) - triangles_.begin());
  }
};

void add_parts(const LatticeSurface& surface, CandidateTree& tree, int halvings, Kept& kept) {
  if (kept.has_all(tree.candidates)) return;
  if (halvings == 0) {
    kept.add(tree.candidates);
    return;
  }
  for (CandidateTree& part : tree.parts(surface)) add_parts(surface, part, halvings - 1, kept);
}

}  // namespace

double CandidatesOfKind::distance() const noexcept {
  return triangles.empty() ? std::numeric_limits<double>::infinity() : triangles.front().distance;
}

double felt_nearer(const LatticeSurface& surface, const Candidates& candidates) noexcept {
  return candidates.sheets.triangles.empty() ? 0 : surface.sheet_thickness;
}

Candidates candidates_of(const LatticeSurface& surface, const std::vector<std::uint32_t>& triangles,
                         const Cube& cube) {
  Near near;
  for (const std::uint32_t triangle : triangles) {
    auto& kind = surface.triangles[triangle].sheet ? near.sheets : near.solids;
    kind.push_back(seen_from(surface, triangle, cube.middle));
  }
  Candidates found;
  narrow(surface, cube, near, found);
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

bool CandidateTree::is_middle_inside(const LatticeSurface& surface) {
  if (!inside_at_middle) {
    NearestPart nearest;
    for (const Candidate& candidate : candidates.solids.triangles) {
      if (candidate.distance - slack > nearest.distance) break;
      nearest.meet(surface.triangles[candidate.triangle], cube.middle);
    }
    inside_at_middle = nearest.is_inside(surface, cube.middle);
  }
  return *inside_at_middle;
}

void CandidateTree::need_witnesses(const LatticeSurface& surface) {
  for (auto* kind : {&candidates.solids, &candidates.sheets}) {
    if (!kind->witnesses.empty()) continue;
    find_witnesses(surface, cube, kind->triangles, std::numeric_limits<double>::infinity(),
                   kind->witnesses);
  }
}

void KeepOctants::operator()(std::array<CandidateTree, 8>* octants) const noexcept {
  std::unique_ptr<std::array<CandidateTree, 8>> gone(octants);
  for (CandidateTree& tree : *gone) {
    tree.octants.reset();
    for (auto* kind : {&tree.candidates.solids, &tree.candidates.sheets}) {
      if (kind->triangles.capacity() > most_kept) kind->triangles = {};
    }
  }
  if (kept_octants.size() < most_octants) kept_octants.push_back(std::move(gone));
}

std::array<CandidateTree, 8>& CandidateTree::parts(const LatticeSurface& surface) {
  if (octants) return *octants;
  if (kept_octants.empty()) {
    octants.reset(new std::array<CandidateTree, 8>);
  } else {
    octants.reset(kept_octants.back().release());
    kept_octants.pop_back();
  }
  const std::array<Near, 8>& near = near_octants(surface, candidates, cube);
  for (std::size_t octant = 0; octant < 8; ++octant) {
    CandidateTree& part = (*octants)[octant];
    part.cube = cube.octant(octant);
    narrow(surface, part.cube, near[octant], part.candidates);
    part.know_side(surface, inside);
  }
  return *octants;
}

void CandidateTree::know_side(const LatticeSurface& surface, std::optional<bool> above) {
  inside = inside_at_middle = above;
  if (!inside && candidates.solids.distance() > cube.radius() + slack) {
    inside = is_middle_inside(surface);
  }
}

CandidateTree candidate_tree(const LatticeSurface& surface, const Cube& cube, Candidates candidates,
                             std::optional<bool> inside) {
  CandidateTree tree{cube, std::move(candidates), {}, {}, nullptr};
  tree.know_side(surface, inside);
  return tree;
}

void keep_nearest(const LatticeSurface& surface, CandidateTree& tree, int halvings) {
  Candidates& all = tree.candidates;
  if (!all.mixed() && all_nearest_to_middles(surface, all.only_kind(), tree.cube)) return;
  Kept kept(all);
  add_parts(surface, tree, halvings, kept);
  for (auto* kind : {&all.solids, &all.sheets}) {
    std::erase_if(kind->triangles, [&](const Candidate& one) { return !kept.has(one.triangle); });
  }
}

}  // namespace spm::baker
