// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_build.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/base/progress_counter.hpp"
#include "baker/charts/chart_field.hpp"
#include "baker/field/chart_fit.hpp"
#include "baker/field/cube_side.hpp"
#include "baker/field/map_proof.hpp"
#include "baker/field/octree_node.hpp"
#include "baker/field/octree_pruning.hpp"
#include "baker/field/octree_words.hpp"
#include "common/base/octahedral.hpp"
#include "common/field/triangle_list.hpp"
#include "formats/asset/chart_words.hpp"

namespace spm::baker {

namespace {

/// Share of the tolerance by which samples may be off; the rest is for places between them.
constexpr double fit_share = 0.85;
/// A cube of few triangles that is so many of its edges away from them is not divided: only where
/// the band is many times as wide as the object there are such cubes, and then too many.
constexpr double far_edges = 5;
/// Around cubes beyond the band only so many triangles are looked at whether they are few.
constexpr std::size_t worth_a_look = 64;

/// Of a map, a sample.
double sample_bytes(bool half) { return half ? sizeof(std::uint16_t) : sizeof(float); }

class Builder {
 public:
  Builder(const Caster& caster, const LatticeSurface& surface, const ChartHeights& heights,
          const Reachability* reachability, const OctreeRules& rules)
      : caster_(caster), surface_(surface), reachability_(reachability), rules_(rules) {
    rules_.tolerance -= surface.displacement;
    charts_ = {&heights, rules.band, fit_share * rules_.tolerance, rules.direction};
  }

  [[nodiscard]] OctreeNode root(const Cube& cube) const {
    OctreeNode node;
    node.cube = cube;
    const ClosestPoint closest = caster_.closest(cube.middle);
    std::vector<std::uint32_t> triangles;
    std::optional<bool> inside;
    if (std::abs(closest.solid) > cube.radius()) inside = closest.solid < 0;
    const bool beyond = decided(node, closest.distance, closest.direction);
    if (beyond && surface_.triangles.size() > worth_a_look) return node;
    double around = std::abs(closest.distance) + 2 * cube.radius();
    // What is felt may be nearer than the middle of a sheet, and a sheet than a solid by rounding.
    if (surface_.sheet_thickness > 0)
      around += 2 * (surface_.sheet_thickness + surface_.displacement);
    caster_.boxes_within(cube.middle, around, triangles);
    CandidateTree tree =
        candidate_tree(surface_, cube, candidates_of(surface_, triangles, cube), inside);
    keep_few(node, tree);
    if (!beyond) answer(node, tree, level_of(cube));
    return node;
  }

 private:
  const Caster& caster_;
  const LatticeSurface& surface_;
  const Reachability* reachability_;
  OctreeRules rules_;
  ChartRules charts_;

  /// Below the largest roots.
  [[nodiscard]] int level_of(const Cube& cube) const {
    return rules_.levels -
           static_cast<int>(std::lround(std::log2(2 * cube.half / rules_.smallest_edge)));
  }

  /// Far, deep and pruned cubes. `distance`, of the middle, is signed.
  bool decided(OctreeNode& node, double distance, const Vector3& direction) const {
    const double reach = node.cube.radius();
    if (distance - reach > rules_.band.margin) {
      node.kind = OctreeKind::far;
      node.clearance = distance;
      return true;
    }
    if (-distance - reach > rules_.band.max_depth) {
      node.kind = OctreeKind::deep;
      node.direction = pack_octahedral(direction);
      return true;
    }
    if (reachability_ == nullptr) return false;
    node.rule = reachability_->cube(node.cube.middle, 2 * node.cube.half);
    if (node.rule != PruneRule::none) node.kind = OctreeKind::pruned;
    return node.rule != PruneRule::none;
  }

  /// Decides what a cube below another one is.
  void decide(OctreeNode& node, CandidateTree& tree, int level) const {
    const Candidates& candidates = tree.candidates;
    keep_few(node, tree);
    double distance = 0;
    Vector3 direction = Vector3::UnitZ();
    if (tree.inside) {
      const double sign = *tree.inside ? -1 : 1;
      distance = sign * candidates.solids.distance();
      if (!candidates.solids.triangles.empty()) {
        direction = sign * candidates.solids.triangles.front().tangent;
      }
      const double sheet = candidates.sheets.distance() - surface_.sheet_thickness;
      if (sheet < distance) {
        distance = sheet;
        direction = candidates.sheets.triangles.front().tangent;
      }
    }
    if (decided(node, distance, direction)) return;
    answer(node, tree, level);
  }

  /// Finds what answers in a cube of the band: maps, or what does in its octants, or a list.
  void answer(OctreeNode& node, CandidateTree& tree, int level) const {
    // Charts are of solids.
    const bool maps = rules_.maps && !tree.candidates.solids.triangles.empty();
    if (maps && tree.candidates.sheets.triangles.empty() && has_maps(node, tree)) return;
    const bool is_far =
        tree.candidates.only_kind().distance() > far_edges * 2 * node.cube.half && node.few;
    if (level < rules_.levels && !is_far) return divide_in_octants(node, tree, level);
    keep_nearest(surface_, tree, 1);
    // Another packet takes as long as a first one, and such lists are most of an octree's words.
    if (tree.candidates.size() > packet_size) keep_nearest(surface_, tree, 4);
    keep_few(node, tree);
    become_list(node, tree);
  }

  void divide_in_octants(OctreeNode& node, CandidateTree& tree, int level) const {
    node.kind = OctreeKind::split;
    node.octants = std::make_unique<std::array<OctreeNode, 8>>();
    std::array<CandidateTree, 8>& within = tree.parts(surface_);
    for (std::size_t octant = 0; octant < 8; ++octant) {
      OctreeNode& part = (*node.octants)[octant];
      part.cube = node.cube.octant(octant);
      decide(part, within[octant], level + 1);
      within[octant].octants.reset();
    }
    join_octants(node);
    if (tree.inside) node.inside = tree.inside;
  }

  /// Remembers the candidates where they are few.
  static void keep_few(OctreeNode& node, const CandidateTree& tree) {
    node.inside = tree.inside;
    if (tree.candidates.size() > few_triangles) {
      node.few.reset();
      return;
    }
    std::vector<std::uint32_t> few;
    for (const auto* kind : {&tree.candidates.solids, &tree.candidates.sheets}) {
      for (const Candidate& candidate : kind->triangles) few.push_back(candidate.triangle);
    }
    node.few = std::move(few);
  }

  /// Whether maps answer within the tolerance everywhere in a cube, which then is theirs.
  bool has_maps(OctreeNode& node, CandidateTree& tree) const {
    const std::optional<FittedCharts> maps = maps_of(tree);
    if (!maps) return false;
    node.kind = OctreeKind::map;
    node.charts = maps->charts;
    node.pair = maps->pair;
    for (const ChartAtLevel& at : maps->charts)
      node.shared_bytes += bytes_of_heights(at, node.cube);
    return true;
  }

  /// The distance maps that are proven to answer in a cube.
  [[nodiscard]] std::optional<FittedCharts> maps_of(CandidateTree& tree) const {
    const std::vector<CubeSample> samples =
        sample_cube(surface_, tree.candidates, tree.cube, tree.inside);
    const auto proven = [&](const FittedCharts& found) {
      std::vector<ChartField> fields;
      std::vector<const BoundedField*> bounded;
      for (const ChartAtLevel& at : found.charts) fields.emplace_back(*charts_.heights, at);
      bounded.reserve(fields.size());
      for (const ChartField& field : fields) bounded.push_back(&field);
      return prove_fields(surface_, tree, found.pair, bounded, rules_.band, rules_.tolerance);
    };
    std::optional<FittedCharts> found = find_one_chart(samples, tree.cube, charts_, proven);
    return found ? found : find_two_charts(samples, tree.cube, charts_, proven);
  }

  /// What a cube's part of a chart's heights takes, which the cubes before and behind it in the
  /// band have too.
  [[nodiscard]] double bytes_of_heights(const ChartAtLevel& at, const Cube& cube) const {
    const double along = 2 * cube.half / charts_.heights->spacing(at.level);
    const double deep = (rules_.band.max_depth + rules_.band.margin) / (2 * cube.half);
    return sample_bytes(charts_.heights->halves()) * along * along / std::max(1.0, deep);
  }

  static void become_list(OctreeNode& node, const CandidateTree& tree) {
    node.kind = OctreeKind::list;
    node.side = side_of(tree.inside);
    const auto listed = [&](const std::vector<Candidate>& from, auto& to) {
      for (const Candidate& candidate : from) {
        // Distances are convex, so nowhere below the tangent.
        const double falls = node.cube.half * candidate.tangent.lpNorm<1>();
        to.push_back({candidate.triangle, std::max(0.0, candidate.distance - falls)});
      }
    };
    listed(tree.candidates.solids.triangles, node.solids);
    listed(tree.candidates.sheets.triangles, node.sheets);
  }
};

/// Lists that the surface passes get places of known side. Returns how many need one and get none.
std::size_t add_known_places(const LatticeSurface& surface, OctreeRoots& roots) {
  std::vector<OctreeNode*> lists;
  const auto add = [&lists](OctreeNode& node, const auto& again) -> void {
    if (node.octants) {
      for (OctreeNode& octant : *node.octants) again(octant, again);
    } else if (node.kind == OctreeKind::list && node.side == ListSide::surface &&
               !node.solids.empty()) {
      lists.push_back(&node);
    }
  };
  for (OctreeNode& root : roots.nodes) add(root, add);
  std::atomic<std::size_t> untold = 0;
  tbb::parallel_for(std::size_t{0}, lists.size(), [&](std::size_t i) {
    OctreeNode& node = *lists[i];
    std::vector<std::uint32_t> solids;
    for (const ListedCandidate& listed : node.solids) solids.push_back(listed.triangle);
    std::optional<CubeSide> side = find_cube_side(surface, node.cube, solids);
    if (!side) {
      untold += any_doubted(surface, solids) ? 1 : 0;
      return;
    }
    node.known = side->known;
    if (!side->passing.empty() && side->passing.front() >= surface.triangles.size()) {
      node.crossed = std::move(side->passing);
    }
  });
  return untold;
}

void need_heights(const OctreeNode& node, Atlas& atlas) {
  if (node.as_list) return;
  if (node.octants) {
    for (const OctreeNode& octant : *node.octants) need_heights(octant, atlas);
    return;
  }
  for (const ChartAtLevel& at : node.charts) atlas.need(at, node.cube.middle, node.cube.half);
}

/// The distance maps that answer in an octree.
Atlas atlas_of(const ChartHeights& heights, const OctreeRoots& roots) {
  Atlas atlas(heights);
  for (const OctreeNode& root : roots.nodes) need_heights(root, atlas);
  return atlas;
}

double bytes_of(const AtlasData& atlas, const std::vector<SupportPlane>& planes) {
  constexpr double chart_bytes = 4 * chart_word_count, plane_bytes = 256;
  return sample_bytes(atlas.halves) * static_cast<double>(atlas.heights.size()) +
         chart_bytes * static_cast<double>(atlas.charts.size()) +
         plane_bytes * static_cast<double>(planes.size());
}

/// Bytes of the distance maps that answer in an octree, more than was reckoned with.
double atlas_excess(const ChartHeights& heights, const OctreeRoots& roots) {
  std::vector<SupportPlane> planes;
  const AtlasData atlas = atlas_of(heights, roots).lay_out(planes);
  return bytes_of(atlas, planes) - shared_bytes(roots);
}

/// Decides which cubes become lists so that octree, maps and triangles keep within the bytes that
/// are given. Throws BakeError where they are too few.
void keep_within(const LatticeSurface& surface, const ChartHeights& heights, double most,
                 OctreeRoots& roots) {
  const auto beside = [&] { return triangle_bytes(surface, roots) + atlas_excess(heights, roots); };
  const double least = find_least_bytes(roots) + beside();
  if (least > most) {
    throw BakeError(ExitCode::tolerance_not_met,
                    fmt::format("the octree takes at least {:.0f} bytes more than --max-bytes "
                                "leaves; take a coarser --tolerance or more bytes",
                                std::ceil(least - most)));
  }
  // Fewer bytes for cubes may need more for triangles.
  constexpr int tries = 16;
  double bytes = most;
  for (int k = 0; k < tries; ++k) {
    const double over = find_fastest(bytes, roots) + beside() - most;
    if (over <= 0) return;
    bytes -= over;
  }
  static_cast<void>(find_least_bytes(roots));
}

}  // namespace

BuiltOctree build_octree(const LatticeSurface& surface, const Caster& caster,
                         const ChartHeights& heights, const Reachability* reachability,
                         const OctreeRules& rules, const Progress& progress) {
  BuiltOctree built;
  OctreeData& data = built.data;
  data.edge = std::ldexp(rules.smallest_edge, rules.levels);
  const double around = rules.band.margin + rules.tolerance + surface.sheet_thickness;
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const LatticeTriangle& triangle : surface.triangles) {
    for (const Vector3& corner : triangle.corners) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  data.origin = low - Vector3::Constant(around);
  for (int axis = 0; axis < 3; ++axis) {
    data.roots[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(
        std::ceil((high[axis] + around - data.origin[axis]) / data.edge));
  }
  data.clearance_unit = caster.diagonal() / 1e6;
  data.beyond_share = beyond_share;
  const std::size_t count = std::size_t{data.roots[0]} * data.roots[1] * data.roots[2];
  OctreeRoots roots;
  roots.count = data.roots;
  roots.nodes.resize(count);
  const Builder builder(caster, surface, heights, reachability, rules);
  ProgressCounter counter(progress, "octree", count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const std::size_t row = i / data.roots[0], layer = row / data.roots[1];
    const Vector3 at(static_cast<double>(i % data.roots[0]),
                     static_cast<double>(row % data.roots[1]), static_cast<double>(layer));
    roots.nodes[i] =
        builder.root({data.origin + data.edge * (at + Vector3::Constant(0.5)), data.edge / 2});
    counter.done();
  });
  const auto make_root = [&builder](const Cube& cube) { return builder.root(cube); };
  if (rules.bytes) {
    keep_within(surface, heights, *rules.bytes, roots);
  } else {
    data.edge = std::ldexp(data.edge, -find_best(surface, rules.levels, make_root, roots));
  }
  data.roots = roots.count;
  data.reach = std::max(rules.band.max_depth, rules.band.margin) + std::sqrt(3.0) * data.edge +
               surface.sheet_thickness;
  make_lists(surface, roots);
  built.untold = add_known_places(surface, roots);
  Atlas atlas = atlas_of(heights, roots);
  built.atlas = atlas.lay_out(built.planes);
  write_words(roots, surface, atlas, built);
  built.counts.bytes += static_cast<std::uint64_t>(bytes_of(built.atlas, built.planes));
  if (built.counts.leaves() == 0) {
    throw BakeError(ExitCode::invalid_input,
                    "nothing of the object is left to model: the probe's centre comes to no place "
                    "of its band; move the object into the workspace, or take a smaller probe");
  }
  return built;
}

}  // namespace spm::baker
