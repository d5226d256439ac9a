// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cube_decider.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "baker/fallback.hpp"
#include "common/closest_on_triangle.hpp"
#include "common/octahedral.hpp"
#include "common/query.hpp"

namespace spm::baker {

namespace {

/// Halvings of a grid cell down to the cubes that lists are made for.
constexpr int finest = 3;
/// And where a list tells the side wrong.
constexpr int deepest = split_levels;
/// Halvings that a file may have for shorter lists alone; more only where the side asks for them.
constexpr int finest_for_length = 1;
/// A cell with more elements than this is halved.
constexpr std::size_t few = 4;
/// Unless its octants' lists would be this share as long in the mean: then nothing is won.
constexpr double worthless_halving = 0.75;
/// A foot that faces its point less than this stands at a border, where sides are tried harder.
constexpr float facing = 0.95F;
/// Halvings more by which lists are made shorter.
constexpr int tightenings = 1;
/// Points along a smallest cube at which sides are tried there.
constexpr int few_tries = 2;
constexpr int many_tries = 4;
/// Trials no farther from the surface than this, in tolerances, are repeated close to it.
constexpr double near_tolerances = 3;

}  // namespace

CubeDecider::CubeDecider(const Asset& asset, const std::vector<Tile>& tiles, const Caster& caster,
                         const FallbackTriangles& fallback, double tolerance,
                         const PruneTest& prune)
    : tiles_(tiles),
      caster_(caster),
      fallback_(fallback),
      tolerance_(tolerance),
      prune_(prune),
      band_(asset.metadata.band),
      smallest_edge_(std::ldexp(asset.grid.cell_size, -deepest)) {
  view_.planes = asset.planes;
  view_.tiles = tiles;
  view_.height_unit = static_cast<float>(asset.metadata.height_unit);
  view_.tolerance = tolerance;
  view_.band = band_;
  view_.grid.cell_size = asset.grid.cell_size;
  fallback.show(view_);
}

/// Elements that may matter in a cube, out of all.
std::vector<std::uint32_t> CubeDecider::all_near(const Vector3& middle, double edge,
                                                  double distance) const {
  const double reach = distance + edge * std::sqrt(3.0) + 2 * tolerance_;
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    const double bound = static_cast<double>(
        tile_distance_bound(tiles_[i], view_.planes[tiles_[i].plane], middle));
    if (bound <= reach) found.push_back(i);
  }
  for (std::uint32_t i = 0; i < fallback_.pieces(); ++i) {
    if (fallback_.lost(i)) continue;
    const auto [a, b, c] = fallback_.corners(i);
    const double size = std::max((b - a).norm(), (c - a).norm());
    if ((a - middle).norm() - size <= reach) found.push_back(i | triangle_flag);
  }
  return found;
}

void CubeDecider::decide(PartitionNode& node, const std::vector<std::uint32_t>& near, int level) const {
  const double radius = node.edge * std::sqrt(3.0) / 2;
  const ClosestPoint centre = caster_.closest(node.middle);
  if (centre.distance - radius > band_.margin + tolerance_) {
    node.side = ListSide::outside;
    return;
  }
  if (centre.distance + radius < -band_.max_depth - tolerance_) {
    node.kind = CellKind::deep;
    node.side = ListSide::inside;
    node.normal = pack_octahedral(centre.direction);
    return;
  }
  node.kind = CellKind::record;
  if (prune_) node.rule = prune_(node.middle, node.edge);
  const bool plain = narrow(node, near, radius);
  if (level < finest) {
    halve(node, level);
    return;
  }
  if (level == finest && node.elements.size() > 1) tighten(node, tightenings);
  if (std::abs(centre.distance) > radius) {
    node.side = centre.distance < 0 ? ListSide::inside : ListSide::outside;
  }
  if (sides_hold(node, centre.distance, plain)) return;
  node.side_needed = node.side != ListSide::told;
  if (node.side_needed) return;
  // Smaller cubes lie on one side more often.
  if (level < deepest) {
    halve(node, level);
  } else {
    fall_back(node, centre.distance);
  }
}

CubeDecider::Claim CubeDecider::ask(std::uint32_t element, const Vector3& point, double limit) const {
  Claim claim;
  if ((element & triangle_flag) != 0) {
    const auto [a, b, c] = fallback_.corners(element & ~triangle_flag);
    const Vector3 foot = closest_on_triangle(point, a, b, c);
    claim.distance = (point - foot).norm();
    const double height = (b - a).cross(c - a).normalized().dot(point - foot);
    claim.inside = height < 0;
    claim.faces = std::abs(height) > static_cast<double>(facing) * claim.distance;
    return claim;
  }
  const Tile& tile = tiles_[element];
  const TileFoot foot = closest_on_tile(tile, view_.height_unit, view_.planes[tile.plane], point,
                                        static_cast<float>(limit));
  claim.distance = static_cast<double>(foot.distance);
  claim.inside = foot.below > 0;
  claim.faces = std::abs(foot.below) > facing * foot.distance;
  return claim;
}

/// Keeps the elements that can be the nearest somewhere in the cube; true where all agree on the
/// side of its middle and face it.
bool CubeDecider::narrow(PartitionNode& node, const std::vector<std::uint32_t>& near, double radius) const {
  double best = std::numeric_limits<double>::infinity();
  std::vector<Claim> claims;
  for (const std::uint32_t element : near) {
    claims.push_back(ask(element, node.middle, best + 2 * radius + tolerance_));
    best = std::min(best, claims.back().distance);
  }
  // The query's foot may be a little farther than the nearest point; see surface_proof.
  const double reach = best + 2 * radius + 0.1 * tolerance_;
  bool inside = false, outside = false, faces = true;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (claims[i].distance > reach) continue;
    node.elements.push_back(near[i]);
    (claims[i].inside ? inside : outside) = true;
    faces = faces && claims[i].faces;
  }
  return faces && inside != outside;
}

void CubeDecider::halve(PartitionNode& node, int level) const {
  auto octants = std::make_unique<std::array<PartitionNode, 8>>();
  std::vector<std::uint32_t> joint;
  bool mixed = false, needed = false;
  std::size_t records = 0, listed = 0;
  for (unsigned octant = 0; octant < 8; ++octant) {
    PartitionNode& part = (*octants)[octant];
    part.edge = node.edge / 2;
    part.middle = node.middle + part.edge / 2 *
                                    Vector3((octant & 1U) != 0 ? 1 : -1,
                                            (octant & 2U) != 0 ? 1 : -1,
                                            (octant & 4U) != 0 ? 1 : -1);
    decide(part, node.elements, level + 1);
    if (part.kind != CellKind::record) continue;
    ++records;
    listed += part.elements.size();
    mixed = mixed || part.exact || part.octants || part.rule != node.rule;
    needed = needed || part.side_needed;
    joint.insert(joint.end(), part.elements.begin(), part.elements.end());
  }
  std::sort(joint.begin(), joint.end());
  joint.erase(std::unique(joint.begin(), joint.end()), joint.end());
  bool one_side = true;
  for (const PartitionNode& part : *octants) one_side = one_side && part.side == octants->front().side;
  if (one_side) node.side = octants->front().side;
  if (needed && node.side == ListSide::told) mixed = true;
  // Below the finest, cubes are halved because their list tells the side wrong: that stays so.
  if (!mixed && level < finest &&
      (joint.size() <= few || level >= finest_for_length ||
       static_cast<double>(listed) >= worthless_halving * static_cast<double>(joint.size() * records))) {
    node.elements = std::move(joint);
    node.side_needed = needed;
    return;
  }
  const bool empty = std::all_of(octants->begin(), octants->end(), [](const auto& part) {
    return part.kind == CellKind::far;
  });
  if (empty) {
    node.kind = CellKind::far;
    node.elements.clear();
    return;
  }
  node.elements = std::move(joint);
  node.octants = std::move(octants);
}

/// Drops the elements that are the nearest in no octant of the cube, nor in theirs.
void CubeDecider::tighten(PartitionNode& node, int times) const {
  const double edge = node.edge / 2;
  const double radius = edge * std::sqrt(3.0) / 2;
  std::vector<std::uint32_t> joint;
  for (unsigned octant = 0; octant < 8; ++octant) {
    PartitionNode part;
    part.edge = edge;
    part.middle = node.middle + edge / 2 *
                                    Vector3((octant & 1U) != 0 ? 1 : -1,
                                            (octant & 2U) != 0 ? 1 : -1,
                                            (octant & 4U) != 0 ? 1 : -1);
    narrow(part, node.elements, radius);
    if (times > 1 && part.elements.size() > 1) tighten(part, times - 1);
    joint.insert(joint.end(), part.elements.begin(), part.elements.end());
  }
  std::sort(joint.begin(), joint.end());
  joint.erase(std::unique(joint.begin(), joint.end()), joint.end());
  node.elements = std::move(joint);
}

/// True where the list tells the side right at all points tried.
bool CubeDecider::sides_hold(const PartitionNode& node, double distance, bool plain) const {
  const std::vector<std::uint32_t> words = words_of(node);
  if (words.empty()) return false;
  Grid grid;
  grid.records = words;
  const GridList list(grid, static_cast<std::uint32_t>(CellKind::record) << 30U);
  if (!try_at(node.middle, distance, list).right) return false;
  if (plain) return true;
  const Trial quick = try_lattice(node, few_tries, list);
  if (!quick.right || quick.faced) return quick.right;
  return try_lattice(node, many_tries, list).right;
}

/// Tries at so many points along each edge.
CubeDecider::Trial CubeDecider::try_lattice(const PartitionNode& node, int tries, const GridList& list) const {
  Trial all;
  for (int k = 0; k < tries * tries * tries && all.right; ++k) {
    const Vector3 place(k % tries, k / tries % tries, k / (tries * tries));
    const Vector3 point =
        node.middle +
        node.edge * ((place + Vector3::Constant(0.5)) / tries - Vector3::Constant(0.5));
    const ClosestPoint closest = caster_.closest(point);
    const Trial one = try_at(point, closest.distance, list);
    all.right = all.right && one.right;
    all.faced = all.faced && one.faced;
    if (one.faced || std::abs(closest.distance) > near_tolerances * tolerance_) continue;
    // Near the surface a wrong side costs less, but is more likely.
    for (const double height : {-0.85, -0.6, 0.6, 0.85}) {
      const Vector3 above = closest.foot + height * tolerance_ * caster_.normal(closest.triangle);
      all.right = all.right && try_at(above, caster_.closest(above).distance, list).right;
    }
  }
  return all;
}

CubeDecider::Trial CubeDecider::try_at(const Vector3& point, double truth, const GridList& list) const {
  if (truth > band_.margin + tolerance_) return {};
  const ListReading reading = read_list(view_, list, point);
  const double answer = answer_of(view_, reading).distance;
  const bool right = truth < -band_.max_depth - tolerance_
                         ? answer < -band_.max_depth + tolerance_
                         : std::abs(answer - truth) <= tolerance_;
  return {right, reading.sides.nearest_faces()};
}

void CubeDecider::fall_back(PartitionNode& node, double distance) const {
  node.exact = true;
  node.elements.clear();
  for (const std::uint32_t triangle :
       closest_candidates(caster_, node.middle, node.edge, distance)) {
    const std::uint32_t number = fallback_.of_caster(triangle);
    if (!fallback_.lost(number)) node.elements.push_back(number | triangle_flag);
  }
}

/// The list of a leaf as a file would hold it, with the numbers of `view_`; none where it is too
/// long.
std::vector<std::uint32_t> CubeDecider::words_of(const PartitionNode& node) const {
  std::vector<std::uint32_t> words{0};
  std::uint32_t surfaces = 0, triangles = 0;
  for (const std::uint32_t element : node.elements) {
    const bool triangle = (element & triangle_flag) != 0;
    words.push_back(triangle ? fallback_.word(element & ~triangle_flag) : element);
    ++(triangle ? triangles : surfaces);
  }
  if (surfaces > most_listed || triangles > most_listed_triangles) return {};
  words[0] = list_header(surfaces, triangles, node.side);
  return words;
}

bool CubeDecider::answers(const PartitionNode& leaf, const Vector3& point) const {
  const std::vector<std::uint32_t> words = words_of(leaf);
  if (words.empty()) return false;
  Grid grid;
  grid.records = words;
  const GridList list(grid, static_cast<std::uint32_t>(CellKind::record) << 30U);
  return try_at(point, caster_.closest(point).distance, list).right;
}

void CubeDecider::mend(PartitionNode& leaf, const Vector3& point) const {
  const double distance = caster_.closest(leaf.middle).distance;
  if (std::abs(distance) > leaf.edge * std::sqrt(3.0) / 2) {
    leaf.side = distance < 0 ? ListSide::inside : ListSide::outside;
    leaf.side_needed = true;
    return;
  }
  if (leaf.edge < 1.5 * smallest_edge_) {
    if (!leaf.exact) fall_back(leaf, distance);
    return;
  }
  leaf.octants = std::make_unique<std::array<PartitionNode, 8>>();
  std::size_t holder = 0;
  for (unsigned octant = 0; octant < 8; ++octant) {
    PartitionNode& part = (*leaf.octants)[octant];
    part.edge = leaf.edge / 2;
    part.middle = leaf.middle + part.edge / 2 *
                                    Vector3((octant & 1U) != 0 ? 1 : -1,
                                            (octant & 2U) != 0 ? 1 : -1,
                                            (octant & 4U) != 0 ? 1 : -1);
    part.kind = CellKind::record;
    const double there = caster_.closest(part.middle).distance;
    if (std::abs(there) > part.edge * std::sqrt(3.0) / 2) {
      part.side = there < 0 ? ListSide::inside : ListSide::outside;
    }
    part.rule = leaf.rule;
    part.exact = leaf.exact;
    part.elements = leaf.elements;
  }
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int k = static_cast<int>(axis);
    if (point[k] >= leaf.middle[k]) holder |= std::size_t{1} << axis;
  }
  mend((*leaf.octants)[holder], point);
}

}  // namespace spm::baker
