// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cgal/trees.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/bench/geometry/sided_mesh.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = baker::TrianglePrimitive<Kernel, Triangles::const_iterator>;
using Tree = baker::CgalTree<Kernel, Primitive>;

/// CGAL's tree with a hint: the closest point on the triangle that was nearest before, or where
/// that is beyond the band what CGAL's own search tree of points gives.
class CgalTree : public Method {
 public:
  explicit CgalTree(const Model& model)
      : mesh_(model), reach_(std::max(model.band.max_depth, model.band.margin)) {
    const Clock::time_point start = Clock::now();
    triangles_.reserve(mesh_.mesh().triangles.size());
    for (std::uint32_t i = 0; i < mesh_.mesh().triangles.size(); ++i) {
      const auto [a, b, c] = mesh_.mesh().corners(i);
      triangles_.emplace_back(point_of(a), point_of(b), point_of(c));
    }
    tree_.insert(triangles_.begin(), triangles_.end());
    tree_.build();
    tree_.accelerate_distance_queries();
    facts_.name = "cgal-aabb";
    facts_.settings = "Simple_cartesian<double>";
    facts_.file_bytes = mesh_.mesh().bytes();
    facts_.resident_bytes = tree_bytes() + mesh_.bytes();
    facts_.open_seconds = mesh_.seconds() + seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    const Kernel::Point_3 asked = point_of(point);
    const Tree::Point_and_primitive_id found =
        tree_.closest_point_and_primitive(asked, hint(point, asked));
    last_ = static_cast<std::uint32_t>(found.second - triangles_.begin());
    return mesh_.answer(point, last_);
  }

 private:
  static Kernel::Point_3 point_of(const Vector3& point) {
    return {point.x(), point.y(), point.z()};
  }

  [[nodiscard]] Tree::Point_and_primitive_id hint(const Vector3& point,
                                                  const Kernel::Point_3& asked) const {
    const Answer before = mesh_.answer(point, last_);
    if (std::abs(before.distance) > reach_) return tree_.best_hint(asked);
    return {point_of(point - before.distance * before.normal), triangles_.begin() + last_};
  }

  /// Per triangle: the triangle, its primitive, a tree node and a hint (a point with its primitive,
  /// and a pointer to it).
  [[nodiscard]] std::uint64_t tree_bytes() const noexcept {
    const std::size_t each = sizeof(Kernel::Triangle_3) + sizeof(Primitive) +
                             sizeof(CGAL::AABB_node<Tree::AABB_traits>) +
                             sizeof(Tree::Point_and_primitive_id) + sizeof(void*);
    return each * triangles_.size();
  }

  SidedMesh mesh_;
  double reach_;  ///< m: of the band
  Triangles triangles_;
  Tree tree_;
  mutable std::uint32_t last_ = 0;  ///< the nearest triangle before
};

}  // namespace

std::unique_ptr<Method> make_cgal_tree(const Model& model) {
  return std::make_unique<CgalTree>(model);
}

}  // namespace spm::bench
