// SPDX-License-Identifier: Apache-2.0
#include "common/index/index_branches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "common/surface/closest_on_triangle.hpp"
#include "common/index/octant_lists.hpp"
#include "common/index/surface_cube.hpp"

namespace spm {

namespace {

/// A cube is not split further where no more groups may hold the nearest.
constexpr std::size_t few_groups = 2;
/// One with so many, or where claims tell the side, is split once more than others; with so very
/// many twice.
constexpr std::size_t many_groups = 5, very_many_groups = 10;
/// Nor one that is smaller than so many times what is usual for two cells, or a triangle where
/// there are no tiles.
constexpr double least_share = 0.8;

/// How much farther than the nearest a unit may be and matter, tolerances: where claims tell the
/// side, and where a foot is only sought that faces the point.
constexpr double claim_slack = 2;
constexpr double facing_slack = 0.75;

/// Normals within this cosine of each other look one way.
constexpr double one_sheet_cosine = 0.7;

/// An element that is visited costs as much as so many groups that are looked at.
constexpr std::size_t visit_looks = 50;

/// A list so long, halved with each level, tells that all lie in each other's way: there an index
/// is of no use.
constexpr std::size_t hopeless_groups = 2048;

[[nodiscard]] bool is_told(CubeKind kind) {
  return kind == CubeKind::told || kind == CubeKind::unknown;
}

/// One leaf of eight that are alike: what matters in none of them does not matter.
bool merge(const std::array<IndexBranch, 8>& octants, IndexBranch& whole) {
  whole.kind = octants.front().kind;
  whole.beyond = octants.front().beyond;
  const bool empty = octants.front().lists.all.empty();
  for (const IndexBranch& octant : octants) {
    if (octant.octants != nullptr || octant.kind != whole.kind ||
        octant.lists.all.empty() != empty) {
      return false;
    }
    whole.beyond = std::min(octant.beyond, whole.beyond);
    add_numbers(octant.lists.nearest, whole.lists.nearest);
    add_numbers(octant.lists.all, whole.lists.all);
  }
  return whole.lists.nearest.size() <= few_groups && whole.lists.all.size() <= index_list_groups;
}

}  // namespace

IndexBrancher::IndexBrancher(const AssetView& asset, const UnitGroupsData& units)
    : asset_(asset),
      units_(units),
      least_edge_(least_share * units.usual_width),
      rounding_(4 * asset.index.slack) {}

/// What all elements say of a point, which only some groups matter to.
ElementReading IndexBrancher::reading_at(const Vector3& point, const GroupNumbers& some) const {
  if (some.size() > index_list_groups) return read_elements(asset_, point, CubeKind::told);
  const std::vector<std::uint32_t> packed =
      IndexLists{{}, some}.packed(asset_.index.has_small_numbers());
  return read_elements(asset_, list_from(packed.data(), CubeKind::told), point);
}

/// Finds what can matter in a cube, of some groups.
IndexCube IndexBrancher::look(const Vector3& middle, double half, const GroupNumbers& some) {
  IndexCube cube;
  cube.middle = middle;
  cube.half = half;
  cube.space = space_at(asset_.space, middle);
  const ElementReading reading = reading_at(middle, some);
  looks_left_ -= std::min(looks_left_, some.size() + visit_looks * reading.visited);
  cube.nearest = reading.nearest.distance;
  cube.inside =
      cube.space == SpaceKind::told ? reading.sides.inside() : cube.space == SpaceKind::inside;
  if (!std::isfinite(cube.nearest)) return cube;
  reaches_.resize(some.size());
  const auto closest = static_cast<float>(rounding_);
  const auto facing = static_cast<float>(facing_slack * asset_.tolerance + rounding_);
  group_reaches(units_.view(), some, surface_cube(asset_, middle, half, reading.nearest),
                static_cast<float>(claim_slack * asset_.tolerance + rounding_), reaches_.data());
  cube.one_sheet = true;
  Vector3 way = Vector3::Zero();
  for (std::size_t i = 0; i < some.size(); ++i) {
    if (reaches_[i].lanes == 0) continue;
    cube.claims.push_back(some[i]);
    if (some[i] >= units_.first_cap) {
      cube.one_sheet = false;
      cube.nearest_cap = std::min(cube.nearest_cap, cap_distance(some[i], middle));
      continue;
    }
    if (reaches_[i].least <= facing) cube.facing.push_back(some[i]);
    if (reaches_[i].least <= closest) cube.closest.push_back(some[i]);
    for (std::size_t lane = 0; lane < group_units && cube.one_sheet; ++lane) {
      if (((reaches_[i].lanes >> lane) & 1U) == 0) continue;
      const Vector3& normal = units_.normals[some[i] * group_units + lane];
      if (way.isZero()) way = normal;
      cube.one_sheet = normal.dot(way) > one_sheet_cosine;
    }
  }
  return cube;
}

double IndexBrancher::cap_distance(std::uint32_t group, const Vector3& point) const {
  const TriangleGroup& caps = units_.triangles[group - units_.cells.size()];
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t lane = 0; lane < group_units; ++lane) {
    Vector3 a, b, c;
    if (caps.corner[0][lane] == empty_lane || !stored_corner(asset_, caps.first[lane], a) ||
        !stored_corner(asset_, caps.second[lane], b) ||
        !stored_corner(asset_, caps.second[lane] + 1, c)) {
      continue;
    }
    least = std::min(least, (point - closest_on_triangle(point, a, b, c)).norm());
  }
  return least;
}

/// Whether a cube has no place where queries ask for the nearest.
bool IndexBrancher::is_beyond(const IndexCube& cube) const {
  const bool outside = cube.space == SpaceKind::outside || cube.space == SpaceKind::far ||
                       (cube.space == SpaceKind::told && !cube.inside);
  const double end = outside ? asset_.band.margin : asset_.band.max_depth;
  return !(cube.nearest - std::numbers::sqrt3 * cube.half <= end + 2 * asset_.tolerance);
}

/// Whether the octants of a cube of this edge may be found faster by enough.
bool IndexBrancher::is_worth_splitting(const IndexBranch& branch, double edge) const {
  const std::size_t count = branch.lists.nearest.size();
  if (count <= few_groups) return false;
  if (edge >= least_edge_) return true;
  if (edge >= least_edge_ / 2) return count >= many_groups || branch.kind == CubeKind::told;
  return edge >= least_edge_ / 4 && count >= very_many_groups;
}

/// What a whole cube is. Clear of all that is near, the side of its middle is that of all; caps
/// part the sides too, and carry no distance.
CubeKind IndexBrancher::kind_of(const IndexCube& cube) const {
  const unsigned whole = spaces_of_cube(asset_.space, cube.middle, cube.half);
  if ((whole & space_bit(SpaceKind::pruned)) != 0) return CubeKind::unknown;
  if (whole == space_bit(SpaceKind::inside)) return CubeKind::inside;
  if (whole == space_bit(SpaceKind::outside)) return CubeKind::outside;
  const bool known = cube.space != SpaceKind::pruned && cube.space != SpaceKind::split;
  const double clear = std::min(cube.nearest, cube.nearest_cap);
  if (known && clear > std::numbers::sqrt3 * cube.half + 2 * asset_.tolerance) {
    return cube.inside ? CubeKind::inside : CubeKind::outside;
  }
  // What is far lies beyond the margin of the nearest too.
  if (cube.one_sheet && !cube.claims.empty()) return CubeKind::one_sheet;
  return whole == space_bit(SpaceKind::told) ? CubeKind::told : CubeKind::unknown;
}

/// Whether a cube that has no place where queries ask for the nearest lies outside.
bool IndexBrancher::is_far(const IndexCube& cube) const {
  const unsigned whole = spaces_of_cube(asset_.space, cube.middle, cube.half);
  constexpr unsigned out = space_bit(SpaceKind::far) | space_bit(SpaceKind::outside);
  return (whole & ~out) == 0 || kind_of(cube) == CubeKind::outside;
}

/// The groups that are nearest to the corners of a cube and to its middle.
GroupNumbers IndexBrancher::nearest_at_corners(const IndexCube& cube) const {
  GroupNumbers found;
  for (unsigned k = 0; k <= 8; ++k) {
    Vector3 at = cube.middle;
    for (unsigned axis = 0; axis < 3 && k < 8; ++axis) {
      at[static_cast<int>(axis)] += ((k >> axis) & 1U) != 0 ? cube.half : -cube.half;
    }
    const NearestUnit nearest =
        nearest_unit(units_.view(), std::span(cube.closest), from_origin(asset_.tree, at));
    if (nearest.is_found()) add_numbers({cube.closest[nearest.which / group_units]}, found);
  }
  return found;
}

/// What is told where queries do not ask for the nearest: outside no more than how far it is. Of
/// what is deeper than the band only the normal is told, the best known.
IndexBranch IndexBrancher::branch_beyond(const IndexCube& cube) {
  IndexBranch branch;
  if (is_far(cube)) {
    branch.kind = CubeKind::far;
    const double beyond = cube.nearest - std::numbers::sqrt3 * cube.half - rounding_;
    branch.beyond = static_cast<float>(std::min(beyond, 1e30) * (1 - 1e-6));
    return branch;
  }
  const std::size_t looks = 9 * cube.closest.size();
  if (kind_of(cube) != CubeKind::inside || looks_left_ < looks) return branch;
  looks_left_ -= looks;
  branch.kind = CubeKind::inside;
  branch.lists.nearest = nearest_at_corners(cube);
  branch.lists.all = branch.lists.nearest;
  return branch;
}

IndexBranch IndexBrancher::branch_of(const IndexCube& cube, std::size_t most_looks) {
  looks_left_ = most_looks;
  return branch_at(cube, 0);
}

IndexBranch IndexBrancher::branch_at(const IndexCube& cube, int level) {
  IndexBranch branch;
  if (is_beyond(cube)) return branch_beyond(cube);
  if (looks_left_ == 0) return branch;
  branch.kind = kind_of(cube);
  const bool claims = is_told(branch.kind);
  branch.lists = {cube.closest, claims ? cube.claims : cube.facing};
  const std::size_t count = branch.lists.all.size();
  std::array<IndexLists, 8> octants;
  octants.fill(branch.lists);
  if (count > few_groups && count <= index_list_groups) {
    looks_left_ -= std::min(looks_left_, count * octant_corners);
    const double slack = (claims ? claim_slack : facing_slack) * asset_.tolerance + rounding_;
    octants = octant_lists(asset_, units_, cube.middle, cube.half, branch.lists.all, slack,
                           rounding_ / 4);
    branch.lists = {};
    for (const IndexLists& octant : octants) {
      add_numbers(octant.nearest, branch.lists.nearest);
      add_numbers(octant.all, branch.lists.all);
    }
  }
  const bool is_long = branch.lists.all.size() > index_list_groups;
  if (level < index_levels && (is_long || is_worth_splitting(branch, 2 * cube.half))) {
    return split(cube, branch.kind, octants, level);
  }
  if (is_long) branch.lists = {};
  return branch;
}

/// A cube in octants, or whole again where that tells no more.
IndexBranch IndexBrancher::split(const IndexCube& cube, CubeKind kind,
                                 std::array<IndexLists, 8>& lists, int level) {
  auto octants = std::make_unique<std::array<IndexBranch, 8>>();
  for (std::uint32_t k = 0; k < octants->size(); ++k) {
    IndexBranch& octant = (*octants)[k];
    octant.kind = kind;
    octant.lists = std::move(lists[k]);
    // What a whole cube is its octants are.
    if (!is_told(kind) && octant.lists.all.size() <= index_list_groups &&
        !is_worth_splitting(octant, cube.half)) {
      continue;
    }
    Vector3 at = cube.middle;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = ((k >> static_cast<unsigned>(axis)) & 1U) != 0;
      at[axis] += upper ? cube.half / 2 : -cube.half / 2;
    }
    IndexCube part = look(at, cube.half / 2, cube.claims);
    if (part.claims.size() > hopeless_groups >> static_cast<unsigned>(level)) {
      octant = {};
      continue;
    }
    keep_numbers(octant.lists.nearest, part.closest);
    keep_numbers(octant.lists.all, part.facing);
    octant = branch_at(part, level + 1);
  }
  IndexBranch whole;
  if (merge(*octants, whole)) return whole;
  whole.lists = {};
  whole.octants = std::move(octants);
  return whole;
}

}  // namespace spm
