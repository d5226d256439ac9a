// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/exact_winding.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cgal/trees.hpp>
#include <iterator>
#include <optional>
#include <vector>

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangles = std::vector<Kernel::Triangle_3>;

Point to_cgal(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

/// Which way the line from `from` to `to` passes a triangle: as its normal points, against it, or
/// through its border (ZERO).
CGAL::Orientation passed(const Point& from, const Point& to, const Kernel::Triangle_3& t) {
  const CGAL::Orientation first = CGAL::orientation(from, to, t[0], t[1]);
  for (int k = 1; k < 3; ++k) {
    if (CGAL::orientation(from, to, t[k], t[(k + 1) % 3]) != first) return CGAL::ZERO;
  }
  return first;
}

}  // namespace

struct ExactWinding::Implementation {
  Triangles triangles;
  CgalTree<Kernel, TrianglePrimitive<Kernel, Triangles::const_iterator>> tree;
  std::array<Vector3, 6> outside;  ///< where ways lead, in general directions

  explicit Implementation(const Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.solid_triangles(); ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      const Kernel::Triangle_3 triangle(to_cgal(mesh.vertices[a]), to_cgal(mesh.vertices[b]),
                                        to_cgal(mesh.vertices[c]));
      if (!triangle.is_degenerate()) triangles.push_back(triangle);
    }
    tree.insert(triangles.cbegin(), triangles.cend());
    tree.build();
    const Vector3 middle = (mesh.box_min + mesh.box_max) / 2;
    for (std::size_t k = 0; k < outside.size(); ++k) {
      Vector3 way(0.0371, -0.0613, 0.0289);
      way[static_cast<int>(k / 2)] = k % 2 == 0 ? 1 : -1;
      outside[k] = middle + 2 * mesh.diagonal * way;
    }
  }

  /// Nothing where the way passes the border of a triangle, unless these are to be left out.
  [[nodiscard]] std::optional<int> turns(const Point& from, const Point& to, bool borders) const {
    std::vector<Triangles::const_iterator> met;
    tree.all_intersected_primitives(Kernel::Segment_3(from, to), std::back_inserter(met));
    int winding = 0;
    for (const auto& triangle : met) {
      const CGAL::Orientation way = passed(from, to, *triangle);
      if (way == CGAL::ZERO && !borders) return std::nullopt;
      winding += way;
    }
    return winding;
  }
};

ExactWinding::ExactWinding(const Mesh& mesh)
    : implementation_(std::make_unique<Implementation>(mesh)) {}

ExactWinding::~ExactWinding() = default;

int ExactWinding::at(const Vector3& point) const {
  const Implementation& self = *implementation_;
  if (self.triangles.empty()) return 0;
  const Point from = to_cgal(point);
  // The shortest way first.
  std::array<Vector3, 6> ends = self.outside;
  std::sort(ends.begin(), ends.end(), [&](const Vector3& one, const Vector3& other) {
    return (one - point).squaredNorm() < (other - point).squaredNorm();
  });
  for (const Vector3& to : ends) {
    if (const auto winding = self.turns(from, to_cgal(to), false)) return *winding;
  }
  return *self.turns(from, to_cgal(ends[0]), true);
}

}  // namespace spm::baker
