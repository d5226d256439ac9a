// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/self_intersection.hpp"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>

#include "baker/base/box_slabs.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

class PairTest {
 public:
  PairTest(std::span<const Vector3> points, std::span<const Triangle> triangles)
      : points_(points), triangles_(triangles) {}

  [[nodiscard]] bool operator()(std::uint32_t first, std::uint32_t second) const {
    // Shared corners first, in the same order on both sides.
    Triangle a = triangles_[first];
    Triangle b = triangles_[second];
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto match = std::find(b.begin() + static_cast<std::ptrdiff_t>(shared), b.end(), a[i]);
      if (match == b.end()) continue;
      std::iter_swap(b.begin() + static_cast<std::ptrdiff_t>(shared), match);
      std::swap(a[shared], a[i]);
      ++shared;
    }
    switch (shared) {
      case 0:
        return CGAL::do_intersect(triangle(a), triangle(b));
      case 1:
        return CGAL::do_intersect(Kernel::Segment_3(point(a[1]), point(a[2])), triangle(b)) ||
               CGAL::do_intersect(Kernel::Segment_3(point(b[1]), point(b[2])), triangle(a));
      case 2:
        return folded(a, b);
      default:
        return true;
    }
  }

 private:
  /// Two triangles on one edge overlap only where one is folded flat onto the other.
  [[nodiscard]] bool folded(const Triangle& a, const Triangle& b) const {
    return CGAL::coplanar(point(a[0]), point(a[1]), point(a[2]), point(b[2])) &&
           CGAL::coplanar_orientation(point(a[0]), point(a[1]), point(a[2]), point(b[2])) ==
               CGAL::POSITIVE;
  }

  [[nodiscard]] Kernel::Point_3 point(std::uint32_t index) const {
    const Vector3& p = points_[index];
    return {p.x(), p.y(), p.z()};
  }
  [[nodiscard]] Kernel::Triangle_3 triangle(const Triangle& t) const {
    return {point(t[0]), point(t[1]), point(t[2])};
  }

  std::span<const Vector3> points_;
  std::span<const Triangle> triangles_;
};

}  // namespace

std::vector<TrianglePair> intersecting_pairs(std::span<const Vector3> points,
                                             std::span<const Triangle> triangles) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    CGAL::Bbox_3 box;
    for (const std::uint32_t corner : triangles[i]) {
      const Vector3& p = points[corner];
      box += CGAL::Bbox_3(p.x(), p.y(), p.z(), p.x(), p.y(), p.z());
    }
    boxes.emplace_back(box, i);
  }
  const PairTest intersect(points, triangles);
  auto pairs = of_meeting_boxes<TrianglePair>(boxes, [&](const Box& a, const Box& b, auto& found) {
    const TrianglePair pair = std::minmax(a.info(), b.info());
    if (intersect(pair.first, pair.second)) found.push_back(pair);
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace spm::baker
