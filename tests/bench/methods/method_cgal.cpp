// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cstdint>
#include <vector>

#include "tests/bench/geometry/triangle_neighbours.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

class CgalTree : public Method {
 public:
  explicit CgalTree(const Model& model)
      : mesh_(model.surface), neighbours_(mesh_), tie_(1e-7 * model.mesh.diagonal) {
    const Clock::time_point start = Clock::now();
    triangles_.reserve(mesh_.triangles.size());
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      const auto [a, b, c] = mesh_.corners(i);
      triangles_.emplace_back(Kernel::Point_3(a.x(), a.y(), a.z()),
                              Kernel::Point_3(b.x(), b.y(), b.z()),
                              Kernel::Point_3(c.x(), c.y(), c.z()));
    }
    tree_.insert(triangles_.begin(), triangles_.end());
    tree_.build();
    tree_.accelerate_distance_queries();
    facts_.name = "cgal-aabb";
    facts_.settings = "Simple_cartesian<double>";
    facts_.bytes = bytes();
    facts_.build_seconds = seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    const auto found = tree_.closest_point_and_primitive({point.x(), point.y(), point.z()});
    const auto triangle = static_cast<std::uint32_t>(found.second - triangles_.begin());
    return neighbours_.answer(mesh_, point, triangle, tie_);
  }

 private:
  /// Per triangle: the triangle, its primitive, a tree node and a hint (a point with its primitive,
  /// and a pointer to it). Also the indexed mesh and the neighbours that decide the side.
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    const std::size_t each = sizeof(Kernel::Triangle_3) + sizeof(Primitive) +
                             sizeof(CGAL::AABB_node<Tree::AABB_traits>) +
                             sizeof(Tree::Point_and_primitive_id) + sizeof(void*);
    return each * triangles_.size() + mesh_.bytes() + neighbours_.bytes();
  }

  FloatMesh mesh_;
  TriangleNeighbours neighbours_;
  double tie_;
  Triangles triangles_;
  Tree tree_;
};

}  // namespace

std::unique_ptr<Method> make_cgal_tree(const Model& model) {
  return std::make_unique<CgalTree>(model);
}

}  // namespace spm::bench
