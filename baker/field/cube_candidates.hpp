// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "baker/cast/cast.hpp"
#include "baker/field/corner_distances.hpp"
#include "baker/field/lattice_surface.hpp"
#include "common/base/octant.hpp"

namespace spm::baker {

/// An axis-aligned cube, m.
struct Cube {
  Vector3 middle = Vector3::Zero();
  double half = 0;  ///< of its edge

  /// Of the ball around it.
  [[nodiscard]] double radius() const noexcept { return std::sqrt(3.0) * half; }
  [[nodiscard]] double volume() const noexcept { return 8 * half * half * half; }
  [[nodiscard]] Cube octant(std::size_t octant) const noexcept {
    return {middle + half / 2 * octant_direction(octant), half / 2};
  }
};

/// A triangle that may be the nearest to some place of a cube, seen from the cube's middle.
struct Candidate {
  std::uint32_t triangle = 0;
  double distance = 0;  ///< unsigned, m
  /// How the distance rises there along each axis: a unit vector away from the closest point, or 0
  /// where the triangle passes. The distance is convex, so it lies above this tangent.
  Vector3 tangent = Vector3::Zero();
};

/// A triangle's distances from the corners of a cube, m. In between it is no farther than they say.
struct Witness {
  std::uint32_t triangle = 0;
  CornerValues distances;
};

/// Triangles of solids, or of sheets, that may be the nearest to some place of a cube.
struct CandidatesOfKind {
  std::vector<Candidate> triangles;  ///< the nearest to the middle first
  std::vector<Witness> witnesses;    ///< some of the nearest, where they were asked for
  /// m, the unsigned distance of the middle; infinite where there is none.
  [[nodiscard]] double distance() const noexcept;
};

/// All triangles that may decide the distance at some place of a cube.
struct Candidates {
  CandidatesOfKind solids, sheets;

  [[nodiscard]] std::size_t size() const noexcept {
    return solids.triangles.size() + sheets.triangles.size();
  }
  [[nodiscard]] bool mixed() const noexcept {
    return !solids.triangles.empty() && !sheets.triangles.empty();
  }
  /// The kind of which there are some, where they are not mixed.
  [[nodiscard]] const CandidatesOfKind& only_kind() const noexcept {
    return sheets.triangles.empty() ? solids : sheets;
  }
};

/// By how much what is felt is nearer than the triangles of candidates that are not mixed, m: 0 but
/// for sheets.
[[nodiscard]] double felt_nearer(const LatticeSurface& surface,
                                 const Candidates& candidates) noexcept;

/// The candidates of a cube among the given triangles. None that matters is left out: a triangle
/// goes where another one is nearer in all of the cube.
[[nodiscard]] Candidates candidates_of(const LatticeSurface& surface,
                                       const std::vector<std::uint32_t>& triangles,
                                       const Cube& cube);

struct CandidateTree;

/// Keeps octants that are let go for those that are asked for next, since to allocate what they
/// hold takes a tenth of a bake.
struct KeepOctants {
  void operator()(std::array<CandidateTree, 8>* octants) const noexcept;
};

/// A cube with its candidates, and its octants with theirs where they were asked for: more than one
/// proof, and the octree below, ask for the same.
struct CandidateTree {
  Cube cube;
  Candidates candidates;
  std::optional<bool> inside;  ///< the side of the whole cube; nothing where a solid passes
  std::optional<bool> inside_at_middle;
  std::unique_ptr<std::array<CandidateTree, 8>, KeepOctants> octants;

  [[nodiscard]] std::array<CandidateTree, 8>& parts(const LatticeSurface& surface);
  [[nodiscard]] bool is_middle_inside(const LatticeSurface& surface);
  void need_witnesses(const LatticeSurface& surface);
  /// Of the whole cube: that of the cube above it, or where no solid passes that of the middle.
  void know_side(const LatticeSurface& surface, std::optional<bool> above);
};
/// The tree of a cube below one of that side.
[[nodiscard]] CandidateTree candidate_tree(const LatticeSurface& surface, const Cube& cube,
                                           Candidates candidates, std::optional<bool> inside);

/// Leaves out candidates that are none in any part, where the cube is halved so often.
void keep_nearest(const LatticeSurface& surface, CandidateTree& tree, int halvings);

/// The part of the surface that is nearest to a point, of the triangles met.
struct NearestPart {
  const LatticeTriangle* triangle = nullptr;
  ClosestFeature closest;
  double distance = std::numeric_limits<double>::infinity();  ///< m

  void meet(const LatticeTriangle& other, const Vector3& point);
  /// Of the solids.
  [[nodiscard]] bool is_inside(const LatticeSurface& surface, const Vector3& point) const;
};

}  // namespace spm::baker
