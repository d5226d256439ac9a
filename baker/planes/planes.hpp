// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "baker/planes/hull.hpp"
#include "common/surface/support_plane.hpp"

namespace spm::baker {

enum class PlaneKind { automatic, face, vertex };

struct SupportPlaneSet {
  std::vector<SupportPlane> planes;
  PlaneKind kind = PlaneKind::face;  ///< face or vertex
};

/// Face-based SPM (Fig. 1b): a support plane through each facet. With `count`, that many facets are
/// taken, spread over the directions and the largest first, so that they still bound the object.
[[nodiscard]] std::vector<SupportPlane> face_based_planes(const Hull& hull,
                                                          std::optional<std::size_t> count);

/// Vertex-based SPM (Fig. 1a) for `count` evenly spread normals (Fibonacci lattice on the sphere).
[[nodiscard]] std::vector<SupportPlane> vertex_based_planes(const Hull& hull, std::size_t count);

/// Evenly spread unit vectors: the Fibonacci lattice.
[[nodiscard]] std::vector<Vector3> fibonacci_directions(std::size_t count);

/// The planes of a `full` asset. `automatic` takes facets where `count` is at most their number,
/// otherwise vertex-based planes only. Without a count it takes all facets up to 1000, otherwise
/// 1000 vertex-based planes. Throws BakeError usage for fewer than 4 planes, or where the planes do
/// not bound the object.
[[nodiscard]] SupportPlaneSet make_support_planes(const Hull& hull, PlaneKind kind,
                                                  std::optional<std::size_t> count);

/// True where the planes' negative half-spaces intersect in a bounded space G (section 2.1). That
/// is so where the normals positively span space.
[[nodiscard]] bool fully_bounding(std::span<const SupportPlane> planes);

/// A rectangle in a plane's parameters, metres.
struct Rectangle {
  double eta_min = 0, eta_max = 0, omega_min = 0, omega_max = 0;
};

/// The bounding rectangle of a plane's own region, in the basis of `planes[which]`. The region is
/// the projection of those points of the bounded space to which no other support plane is closer.
/// Four linear programmes in three variables (Seidel's algorithm, seeded). Empty (min > max) where
/// no point is closest.
[[nodiscard]] Rectangle own_region(std::span<const SupportPlane> planes, std::size_t which);

}  // namespace spm::baker
