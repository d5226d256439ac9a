// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/triangle_fan.hpp"

#include <algorithm>

namespace spm::baker {
namespace {

using Point = ExactKernel::Point_3;

/// Where a triangle stands around an edge, as seen from a first one.
enum class Turn { none, less_than_half, half, more_than_half };

struct Leaf {
  Point tip;
  HalfEdge user;
  Turn turn = Turn::none;
};

[[nodiscard]] Turn turn_of(const Point& a, const Point& b, const Point& first, const Point& tip) {
  switch (CGAL::orientation(a, b, first, tip)) {
    case CGAL::POSITIVE:
      return Turn::less_than_half;
    case CGAL::NEGATIVE:
      return Turn::more_than_half;
    default:
      return CGAL::coplanar_orientation(a, b, first, tip) == CGAL::POSITIVE ? Turn::none
                                                                            : Turn::half;
  }
}

}  // namespace

std::vector<FanLeaf> triangle_fan(const std::vector<Triangle>& triangles,
                                  std::span<const HalfEdge> users,
                                  const std::function<Point(std::uint32_t)>& place) {
  const Point a = place(users[0].low), b = place(users[0].high);
  std::vector<Leaf> leaves;
  for (const HalfEdge& user : users) {
    leaves.push_back({place(tip_of(triangles[user.triangle], user)), user});
  }
  for (std::size_t i = 1; i < leaves.size(); ++i) {
    leaves[i].turn = turn_of(a, b, leaves[0].tip, leaves[i].tip);
  }
  const auto between = [&](const Leaf& one, const Leaf& other) {
    if (one.turn == Turn::none || one.turn == Turn::half) return CGAL::COPLANAR;
    return CGAL::orientation(a, b, one.tip, other.tip);
  };
  std::stable_sort(leaves.begin() + 1, leaves.end(), [&](const Leaf& one, const Leaf& other) {
    return one.turn != other.turn ? one.turn < other.turn : between(one, other) == CGAL::POSITIVE;
  });
  std::vector<FanLeaf> fan;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const bool on_last = i > 0 && leaves[i - 1].turn == leaves[i].turn &&
                         between(leaves[i - 1], leaves[i]) == CGAL::COPLANAR;
    fan.push_back({leaves[i].user, on_last});
  }
  return fan;
}

}  // namespace spm::baker
