// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/base/seen_along.hpp"

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/iterator/function_output_iterator.hpp>
#include <utility>

namespace spm::baker {
namespace {

namespace geometry = boost::geometry;
using Place = geometry::model::point<double, 2, geometry::cs::cartesian>;
using Box = geometry::model::box<Place>;

/// Of the largest coordinate, by how much boxes reach farther: far above rounding.
constexpr double slack = 1e-9;

}  // namespace

struct SeenAlong::Tree {
  geometry::index::rtree<std::pair<Box, std::uint32_t>, geometry::index::linear<16>> boxes;
};

SeenAlong::SeenAlong(const Vector3& way, std::span<const std::array<Vector3, 3>> triangles)
    : way_(way) {
  way.cwiseAbs().maxCoeff(&axis_);
  double most = 0;
  for (const auto& corners : triangles) {
    for (const Vector3& corner : corners) most = std::max(most, corner.lpNorm<Eigen::Infinity>());
  }
  std::vector<std::pair<Box, std::uint32_t>> boxes;
  boxes.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const OnPlane p = seen(a), q = seen(b), r = seen(c);
    const auto [left, right] = std::minmax({p[0], q[0], r[0]});
    const auto [bottom, top] = std::minmax({p[1], q[1], r[1]});
    const double more = slack * most;
    boxes.emplace_back(Box({left - more, bottom - more}, {right + more, top + more}),
                       static_cast<std::uint32_t>(boxes.size()));
  }
  tree_ = std::make_shared<Tree>(Tree{{boxes.begin(), boxes.end()}});
}

std::vector<std::uint32_t> SeenAlong::over(const Vector3& point) const {
  std::vector<std::uint32_t> found;
  if (!tree_) return found;
  const OnPlane at = seen(point);
  tree_->boxes.query(geometry::index::intersects(Place(at[0], at[1])),
                     boost::make_function_output_iterator(
                         [&found](const auto& one) { found.push_back(one.second); }));
  std::sort(found.begin(), found.end());
  return found;
}

SeenAlong::OnPlane SeenAlong::seen(const Vector3& p) const {
  const int first = (axis_ + 1) % 3, second = (axis_ + 2) % 3;
  const double height = p[axis_] / way_[axis_];
  return {p[first] - height * way_[first], p[second] - height * way_[second]};
}

}  // namespace spm::baker
