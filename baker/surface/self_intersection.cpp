// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/self_intersection.hpp"

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "baker/base/meeting_boxes.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

/// Of the angle between the normals of triangles that face each other.
constexpr double facing_cosine = -0.98;

class PairTest {
 public:
  PairTest(std::span<const Vector3> points, std::span<const Triangle> triangles, double near,
           std::size_t solids)
      : points_(points), triangles_(triangles), near_(near), solids_(solids) {}

  [[nodiscard]] bool crossing(std::uint32_t first, std::uint32_t second) const {
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

  [[nodiscard]] bool facing(std::uint32_t first, std::uint32_t second) const {
    if (!(near_ > 0)) return false;
    const Triangle &a = triangles_[first], &b = triangles_[second];
    const Vector3 up = normal(a), other = normal(b);
    if (first >= solids_) return false;
    const double along = up.dot(other), turned = second < solids_ ? along : -std::abs(along);
    if (!(turned < facing_cosine * up.norm() * other.norm())) return false;
    return (is_near(a, b) || is_near(b, a)) && cover(a, b) && !in_one_plane(a, b);
  }

 private:
  /// Twice the area, along the normal.
  [[nodiscard]] Vector3 normal(const Triangle& t) const {
    return (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
  }

  /// Whether all corners of one lie near the plane of the other.
  [[nodiscard]] bool is_near(const Triangle& one, const Triangle& other) const {
    const Vector3 up = normal(other).normalized();
    return std::all_of(one.begin(), one.end(), [&](std::uint32_t corner) {
      return std::abs(up.dot(points_[corner] - points_[other[0]])) <= near_;
    });
  }

  /// Whether there is no gap at all: what lies on each other is cut as one.
  [[nodiscard]] bool in_one_plane(const Triangle& a, const Triangle& b) const {
    return std::all_of(b.begin(), b.end(), [&](std::uint32_t corner) {
      return CGAL::coplanar(point(a[0]), point(a[1]), point(a[2]), point(corner));
    });
  }

  /// Whether they overlap as seen along the normal of one: no side of either has the other beyond.
  [[nodiscard]] bool cover(const Triangle& a, const Triangle& b) const {
    const Vector3 up = normal(a).normalized();
    for (const auto& [own, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
      const double turn = own == &a ? 1 : -1;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3& from = points_[(*own)[k]];
        const Vector3 inwards = turn * up.cross(points_[(*own)[(k + 1) % 3]] - from).normalized();
        const auto reaches_in = [&](std::uint32_t corner) {
          return inwards.dot(points_[corner] - from) > 0;
        };
        if (std::none_of(other->begin(), other->end(), reaches_in)) return false;
      }
    }
    return true;
  }

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
  double near_;  ///< m
  std::size_t solids_;
};

}  // namespace

MeetingPairs meeting_pairs(std::span<const Vector3> points, std::span<const Triangle> triangles,
                           double near, std::size_t solids) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    Eigen::AlignedBox3d box;
    for (const std::uint32_t corner : triangles[i]) box.extend(points[corner]);
    const Vector3 low = box.min().array() - near / 2, high = box.max().array() + near / 2;
    boxes.emplace_back(CGAL::Bbox_3(low.x(), low.y(), low.z(), high.x(), high.y(), high.z()), i);
  }
  const PairTest test(points, triangles, near, solids);
  struct Found {
    TrianglePair pair;
    bool crossing, facing;
  };
  const auto all = of_meeting_boxes<Found>(boxes, [&](const Box& a, const Box& b, auto& found) {
    const TrianglePair pair = std::minmax(a.info(), b.info());
    const Found one{pair, test.crossing(pair.first, pair.second),
                    test.facing(pair.first, pair.second)};
    if (one.crossing || one.facing) found.push_back(one);
  });
  MeetingPairs pairs;
  for (const Found& one : all) {
    if (one.crossing) pairs.crossing.push_back(one.pair);
    if (one.facing) pairs.facing.push_back(one.pair);
  }
  std::sort(pairs.crossing.begin(), pairs.crossing.end());
  std::sort(pairs.facing.begin(), pairs.facing.end());
  return pairs;
}

}  // namespace spm::baker
