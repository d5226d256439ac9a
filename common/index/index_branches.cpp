// SPDX-License-Identifier: Apache-2.0
#include "common/index/index_branches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "common/index/octant_lists.hpp"
#include "common/index/surface_cube.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm {

namespace {

/// A cube is not split further where no more packets may hold the nearest.
constexpr std::size_t few_packets = 2;
/// One with so many, or where votes tell the side, is split once more than others; with so very
/// many twice.
constexpr std::size_t many_packets = 5, very_many_packets = 10;
/// Nor one that is smaller than so many times what is usual for two cells, or a triangle where
/// there are no tiles.
constexpr double min_share = 0.8;

/// How much farther than the nearest a primitive may be and matter, tolerances: where votes tell
/// the side, and where a closest point is only sought that faces the point.
constexpr double vote_slack = 2;
constexpr double facing_slack = 0.75;

/// Normals within this cosine of each other look one way.
constexpr double one_sided_cosine = 0.7;

/// An element that is visited costs as much as so many packets that are looked at.
constexpr std::size_t visit_cost = 50;

/// A list so long, halved with each level, tells that all lie in each other's way: there an index
/// is of no use.
constexpr std::size_t hopeless_packets = 2048;

[[nodiscard]] bool is_boundary(CubeKind kind) {
  return kind == CubeKind::boundary || kind == CubeKind::unknown;
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
  return whole.lists.nearest.size() <= few_packets && whole.lists.all.size() <= index_list_packets;
}

}  // namespace

IndexBrancher::IndexBrancher(const AssetView& asset, const PrimitivePacketsData& primitives)
    : asset_(asset),
      primitives_(primitives),
      min_edge_(min_share * primitives.median_width),
      rounding_(4 * asset.index.slack) {}

/// What all elements say of a point, which only some packets matter to.
ElementReading IndexBrancher::reading_at(const Vector3& point, const PacketNumbers& some) const {
  if (some.size() > index_list_packets) return read_elements(asset_, point, CubeKind::boundary);
  const std::vector<std::uint32_t> packed =
      IndexLists{{}, some}.packed(asset_.index.has_small_numbers());
  return read_elements(asset_, list_from(packed.data(), CubeKind::boundary), point);
}

/// Finds what can matter in a cube, of some packets.
IndexCube IndexBrancher::look(const Vector3& middle, double half, const PacketNumbers& some) {
  IndexCube cube;
  cube.middle = middle;
  cube.half = half;
  cube.sign = sign_at(asset_.sign_octree, middle);
  const ElementReading reading = reading_at(middle, some);
  budget_left_ -= std::min(budget_left_, some.size() + visit_cost * reading.visited);
  cube.nearest = reading.nearest.distance;
  cube.inside =
      cube.sign == SignKind::boundary ? reading.sides.inside() : cube.sign == SignKind::inside;
  if (!std::isfinite(cube.nearest)) return cube;
  bounds_.resize(some.size());
  const auto closest = static_cast<float>(rounding_);
  const auto facing = static_cast<float>(facing_slack * asset_.tolerance + rounding_);
  packet_bounds(primitives_.view(), some, surface_cube(asset_, middle, half, reading.nearest),
                static_cast<float>(vote_slack * asset_.tolerance + rounding_), bounds_.data());
  cube.one_sided = true;
  Vector3 way = Vector3::Zero();
  for (std::size_t i = 0; i < some.size(); ++i) {
    if (bounds_[i].lanes == 0) continue;
    cube.votes.push_back(some[i]);
    if (some[i] >= primitives_.first_cap) {
      cube.one_sided = false;
      cube.nearest_cap = std::min(cube.nearest_cap, cap_distance(some[i], middle));
      continue;
    }
    if (bounds_[i].lower_bound <= facing) cube.facing.push_back(some[i]);
    if (bounds_[i].lower_bound <= closest) cube.closest.push_back(some[i]);
    for (std::size_t lane = 0; lane < packet_width && cube.one_sided; ++lane) {
      if (((bounds_[i].lanes >> lane) & 1U) == 0) continue;
      const Vector3& normal = primitives_.normals[some[i] * packet_width + lane];
      if (way.isZero()) way = normal;
      cube.one_sided = normal.dot(way) > one_sided_cosine;
    }
  }
  return cube;
}

double IndexBrancher::cap_distance(std::uint32_t packet, const Vector3& point) const {
  const TrianglePacket& caps = primitives_.triangles[packet - primitives_.cells.size()];
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t lane = 0; lane < packet_width; ++lane) {
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
  const bool outside = cube.sign == SignKind::outside || cube.sign == SignKind::far ||
                       (cube.sign == SignKind::boundary && !cube.inside);
  const double end = outside ? asset_.band.margin : asset_.band.max_depth;
  return !(cube.nearest - std::numbers::sqrt3 * cube.half <= end + 2 * asset_.tolerance);
}

/// Whether the octants of a cube of this edge may be found faster by enough.
bool IndexBrancher::is_worth_splitting(const IndexBranch& branch, double edge) const {
  const std::size_t count = branch.lists.nearest.size();
  if (count <= few_packets) return false;
  if (edge >= min_edge_) return true;
  if (edge >= min_edge_ / 2) return count >= many_packets || branch.kind == CubeKind::boundary;
  return edge >= min_edge_ / 4 && count >= very_many_packets;
}

/// What a whole cube is. Clear of all that is near, the side of its middle is that of all; caps
/// part the sides too, and carry no distance.
CubeKind IndexBrancher::kind_of(const IndexCube& cube) const {
  const unsigned whole = signs_of_cube(asset_.sign_octree, cube.middle, cube.half);
  if ((whole & sign_bit(SignKind::pruned)) != 0) return CubeKind::unknown;
  if (whole == sign_bit(SignKind::inside)) return CubeKind::inside;
  if (whole == sign_bit(SignKind::outside)) return CubeKind::outside;
  const bool known = cube.sign != SignKind::pruned && cube.sign != SignKind::split;
  const double clear = std::min(cube.nearest, cube.nearest_cap);
  if (known && clear > std::numbers::sqrt3 * cube.half + 2 * asset_.tolerance) {
    return cube.inside ? CubeKind::inside : CubeKind::outside;
  }
  // What is far lies beyond the margin of the nearest too.
  if (cube.one_sided && !cube.votes.empty()) return CubeKind::one_sided;
  return whole == sign_bit(SignKind::boundary) ? CubeKind::boundary : CubeKind::unknown;
}

/// Whether a cube that has no place where queries ask for the nearest lies outside.
bool IndexBrancher::is_far(const IndexCube& cube) const {
  const unsigned whole = signs_of_cube(asset_.sign_octree, cube.middle, cube.half);
  constexpr unsigned out = sign_bit(SignKind::far) | sign_bit(SignKind::outside);
  return (whole & ~out) == 0 || kind_of(cube) == CubeKind::outside;
}

/// The packets that are nearest to the corners of a cube and to its middle.
PacketNumbers IndexBrancher::nearest_at_corners(const IndexCube& cube) const {
  PacketNumbers found;
  for (unsigned k = 0; k <= 8; ++k) {
    Vector3 at = cube.middle;
    for (unsigned axis = 0; axis < 3 && k < 8; ++axis) {
      at[static_cast<int>(axis)] += ((k >> axis) & 1U) != 0 ? cube.half : -cube.half;
    }
    const NearestPrimitive nearest =
        nearest_primitive(primitives_.view(), std::span(cube.closest), from_origin(asset_.bvh, at));
    if (nearest.is_found()) add_numbers({cube.closest[nearest.which / packet_width]}, found);
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
  const std::size_t cost = 9 * cube.closest.size();
  if (kind_of(cube) != CubeKind::inside || budget_left_ < cost) return branch;
  budget_left_ -= cost;
  branch.kind = CubeKind::inside;
  branch.lists.nearest = nearest_at_corners(cube);
  branch.lists.all = branch.lists.nearest;
  return branch;
}

IndexBranch IndexBrancher::branch_of(const IndexCube& cube, std::size_t budget) {
  budget_left_ = budget;
  return branch_at(cube, 0);
}

IndexBranch IndexBrancher::branch_at(const IndexCube& cube, int level) {
  IndexBranch branch;
  if (is_beyond(cube)) return branch_beyond(cube);
  if (budget_left_ == 0) return branch;
  branch.kind = kind_of(cube);
  const bool votes = is_boundary(branch.kind);
  branch.lists = {cube.closest, votes ? cube.votes : cube.facing};
  const std::size_t count = branch.lists.all.size();
  std::array<IndexLists, 8> octants;
  octants.fill(branch.lists);
  if (count > few_packets && count <= index_list_packets) {
    budget_left_ -= std::min(budget_left_, count * octant_corners);
    const double slack = (votes ? vote_slack : facing_slack) * asset_.tolerance + rounding_;
    octants = octant_lists(asset_, primitives_, cube.middle, cube.half, branch.lists.all, slack,
                           rounding_ / 4);
    branch.lists = {};
    for (const IndexLists& octant : octants) {
      add_numbers(octant.nearest, branch.lists.nearest);
      add_numbers(octant.all, branch.lists.all);
    }
  }
  const bool is_long = branch.lists.all.size() > index_list_packets;
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
    if (!is_boundary(kind) && octant.lists.all.size() <= index_list_packets &&
        !is_worth_splitting(octant, cube.half)) {
      continue;
    }
    Vector3 at = cube.middle;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = ((k >> static_cast<unsigned>(axis)) & 1U) != 0;
      at[axis] += upper ? cube.half / 2 : -cube.half / 2;
    }
    IndexCube part = look(at, cube.half / 2, cube.votes);
    if (part.votes.size() > hopeless_packets >> static_cast<unsigned>(level)) {
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
