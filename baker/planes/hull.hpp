// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/vector.hpp"

namespace spm::baker {

/// A facet of the convex hull, after near-coplanar triangles were merged.
struct HullFacet {
  Vector3 normal;   ///< unit, outward
  Vector3 point;    ///< the facet's area centroid, moved along the normal onto the support plane
  double area = 0;  ///< m2
};

struct Hull {
  std::vector<Vector3> vertices;  ///< of the convex hull
  std::vector<HullFacet> facets;  ///< merged, in a fixed order
};

/// Convex hull (CGAL). Facets are merged where their normals differ by less than `coplanar_angle`
/// radians, across their shared edge and in total. The plane of each facet is moved out to touch
/// the farthest vertex, so that it is a support plane (Definition 1) in floating point too. Throws
/// BakeError invalid_input where all points lie in a plane.
[[nodiscard]] Hull convex_hull(std::span<const Vector3> points, double coplanar_angle = 1e-4);

/// The same without the facets, which take long where a round object has many.
[[nodiscard]] Hull convex_hull_vertices(std::span<const Vector3> points);

}  // namespace spm::baker
