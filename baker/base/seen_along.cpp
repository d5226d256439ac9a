// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/base/seen_along.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace spm::baker {
namespace {

/// By how much of a cell triangles reach farther: far above rounding.
constexpr double slack = 1e-6;
/// Cells along the longer side of what is seen: so many times the root of the triangles' number,
/// and at most.
constexpr double cells_along = 4, most_along = 1024;
/// A cell over which more lie is divided further, into fewer cells; so many times at most.
constexpr std::size_t crowded = 256;
constexpr double finer_along = 0.5;
constexpr int deepest = 1;

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

/// The first and the last of so many cells from one place to another, which may be none.
[[nodiscard]] std::array<std::int64_t, 2> cells_between(double from, double to,
                                                        std::int64_t count) {
  const double last = static_cast<double>(count) - 1;
  return {static_cast<std::int64_t>(std::clamp(std::floor(from - slack), 0.0, last + 1)),
          static_cast<std::int64_t>(std::clamp(std::floor(to + slack), -1.0, last))};
}

/// Lists a triangle, as it is seen, row by row.
void list(std::array<Vector3, 3> at, std::uint32_t number, const CubeGrid& cells,
          std::vector<CubeBins::Member>& members) {
  for (Vector3& corner : at) corner = (corner - cells.low) / cells.edge;
  const auto [low, high] = std::minmax({at[0].y(), at[1].y(), at[2].y()});
  const auto [bottom, top] = cells_between(low, high, cells.count[1]);
  for (std::int64_t row = bottom; row <= top; ++row) {
    Eigen::AlignedBox1d reach;
    for (std::size_t k = 0; k < 3; ++k) {
      reach.extend(between(at[k], at[(k + 1) % 3], static_cast<double>(row) - slack,
                           static_cast<double>(row + 1) + slack));
    }
    if (reach.isEmpty()) continue;
    const auto [first, last] = cells_between(reach.min()[0], reach.max()[0], cells.count[0]);
    for (std::int64_t column = first; column <= last; ++column) {
      members.emplace_back(cells.number(column, row, 0), number);
    }
  }
}

}  // namespace

SeenAlong::SeenAlong(const Vector3& way, std::span<const std::array<Vector3, 3>> triangles)
    : way_(way) {
  way.cwiseAbs().maxCoeff(&axis_);
  Eigen::AlignedBox3d box;
  std::vector<Corners> as_seen;
  for (const auto& [a, b, c] : triangles) {
    as_seen.push_back({seen(a), seen(b), seen(c)});
    for (const Vector3& corner : as_seen.back()) box.extend(corner);
  }
  if (box.isEmpty() || !(box.sizes().maxCoeff() > 0)) return;
  std::vector<std::uint32_t> all(triangles.size());
  std::iota(all.begin(), all.end(), 0);
  add_level(box.min(), box.sizes(), as_seen, all, 0);
}

std::span<const std::uint32_t> SeenAlong::over(const Vector3& point) const {
  const Vector3 place = seen(point);
  const Level* level = levels_.data();
  while (!levels_.empty()) {
    const std::optional<std::size_t> cell = level->cells.find(place);
    if (!cell) break;
    const std::uint32_t finer = level->finer.empty() ? 0 : level->finer[*cell];
    if (finer == 0) return level->over.of(*cell, *cell);
    level = &levels_[finer];
  }
  return {};
}

/// Where a place is seen: on the plane across the axis.
Vector3 SeenAlong::seen(const Vector3& p) const {
  const int first = (axis_ + 1) % 3, second = (axis_ + 2) % 3;
  const double height = p[axis_] / way_[axis_];
  return {p[first] - height * way_[first], p[second] - height * way_[second], 0};
}

/// Adds a level over a box, of some of the triangles as they are seen, and those below it. Returns
/// its number.
std::uint32_t SeenAlong::add_level(const Vector3& low, const Vector3& size,
                                   std::span<const Corners> triangles,
                                   std::span<const std::uint32_t> numbers, int depth) {
  const double per_root = depth == 0 ? cells_along : finer_along;
  const double along =
      std::clamp(per_root * std::sqrt(static_cast<double>(numbers.size())), 1.0, most_along);
  const double edge = size.maxCoeff() / along;
  const Vector3 margin(slack * edge, slack * edge, 0);
  Level level;
  level.cells = CubeGrid(low - margin, size + 2 * margin, edge);
  std::vector<CubeBins::Member> members;
  for (const std::uint32_t one : numbers) list(triangles[one], one, level.cells, members);
  level.over = CubeBins(level.cells.cubes(), members);
  const auto own = static_cast<std::uint32_t>(levels_.size());
  levels_.push_back(std::move(level));
  if (depth == deepest) return own;
  const CubeGrid cells = levels_[own].cells;
  std::vector<std::uint32_t> finer;
  for (std::size_t cell = 0; cell < cells.cubes(); ++cell) {
    const std::span<const std::uint32_t> over = levels_[own].over.of(cell, cell);
    if (over.size() <= crowded) continue;
    const auto columns = static_cast<std::size_t>(cells.count[0]);
    const std::size_t column = cell % columns, row = cell / columns;
    const Vector3 corner(static_cast<double>(column), static_cast<double>(row), 0);
    finer.resize(cells.cubes(), 0);
    const std::vector<std::uint32_t> crowd(over.begin(), over.end());
    finer[cell] = add_level(cells.low + cells.edge * corner, Vector3(cells.edge, cells.edge, 0),
                            triangles, crowd, depth + 1);
  }
  levels_[own].finer = std::move(finer);
  return own;
}

}  // namespace spm::baker
