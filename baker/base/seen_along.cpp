// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/base/seen_along.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace spm::baker {
namespace {

/// By how much of a cell triangles reach farther: far above rounding.
constexpr double slack = 1e-6;
/// Cells along the longer side of what is seen: so many times the root of the triangles' number,
/// and at most.
constexpr double cells_along = 4, most_along = 1024;

/// Where a side is lowest and highest between two heights; nothing where it does not pass there.
[[nodiscard]] Eigen::AlignedBox1d between(const Vector3& from, const Vector3& to, double bottom,
                                          double top) {
  Eigen::AlignedBox1d reach;
  if (std::max(from.y(), to.y()) < bottom || std::min(from.y(), to.y()) > top) return reach;
  const double rise = to.y() - from.y();
  for (const double height : {bottom, top}) {
    const double level = height == bottom ? 0 : 1;
    const double share = rise == 0 ? level : std::clamp((height - from.y()) / rise, 0.0, 1.0);
    reach.extend(Eigen::Matrix<double, 1, 1>(from.x() + share * (to.x() - from.x())));
  }
  return reach;
}

/// The first and the last of so many cells from one place to another.
[[nodiscard]] std::array<std::int64_t, 2> cells_between(double from, double to,
                                                        std::int64_t count) {
  const auto cell = [count](double place) {
    return std::clamp(static_cast<std::int64_t>(std::floor(place)), std::int64_t{0}, count - 1);
  };
  return {cell(from - slack), cell(to + slack)};
}

}  // namespace

SeenAlong::SeenAlong(const Vector3& way, std::span<const std::array<Vector3, 3>> triangles)
    : way_(way) {
  way.cwiseAbs().maxCoeff(&axis_);
  Eigen::AlignedBox3d box;
  for (const std::array<Vector3, 3>& triangle : triangles) {
    for (const Vector3& corner : triangle) box.extend(seen(corner));
  }
  if (box.isEmpty() || !(box.sizes().maxCoeff() > 0)) return;
  const double along =
      std::clamp(cells_along * std::sqrt(static_cast<double>(triangles.size())), 1.0, most_along);
  const double edge = box.sizes().maxCoeff() / along;
  const Vector3 margin(slack * edge, slack * edge, 0);
  cells_ = CubeGrid(box.min() - margin, box.sizes() + 2 * margin, edge);
  std::vector<CubeBins::Member> members;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) list(triangles[i], i, members);
  over_ = CubeBins(cells_.cubes(), members);
}

std::span<const std::uint32_t> SeenAlong::over(const Vector3& point) const {
  const std::optional<std::size_t> cell = cells_.find(seen(point));
  return cell ? over_.of(*cell, *cell) : std::span<const std::uint32_t>();
}

/// Where a place is seen: on the plane across the axis.
Vector3 SeenAlong::seen(const Vector3& p) const {
  const int first = (axis_ + 1) % 3, second = (axis_ + 2) % 3;
  const double height = p[axis_] / way_[axis_];
  return {p[first] - height * way_[first], p[second] - height * way_[second], 0};
}

/// Lists a triangle row by row.
void SeenAlong::list(const std::array<Vector3, 3>& triangle, std::uint32_t number,
                     std::vector<CubeBins::Member>& members) const {
  std::array<Vector3, 3> at;
  std::transform(triangle.begin(), triangle.end(), at.begin(), [&](const Vector3& corner) {
    return Vector3((seen(corner) - cells_.low) / cells_.edge);
  });
  const auto [low, high] = std::minmax({at[0].y(), at[1].y(), at[2].y()});
  const auto [bottom, top] = cells_between(low, high, cells_.count[1]);
  for (std::int64_t row = bottom; row <= top; ++row) {
    Eigen::AlignedBox1d reach;
    for (std::size_t k = 0; k < 3; ++k) {
      reach.extend(between(at[k], at[(k + 1) % 3], static_cast<double>(row) - slack,
                           static_cast<double>(row + 1) + slack));
    }
    if (reach.isEmpty()) continue;
    const auto [first, last] = cells_between(reach.min()[0], reach.max()[0], cells_.count[0]);
    for (std::int64_t column = first; column <= last; ++column) {
      members.emplace_back(cells_.number(column, row, 0), number);
    }
  }
}

}  // namespace spm::baker
