// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/octree_build.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "baker/base/bake_error.hpp"
#include "baker/base/progress_counter.hpp"
#include "baker/field/map_fit.hpp"
#include "baker/field/map_proof.hpp"
#include "baker/field/octree_node.hpp"
#include "baker/field/octree_words.hpp"
#include "common/base/octahedral.hpp"
#include "common/field/triangle_cluster.hpp"

namespace spm::baker {

namespace {

/// Share of the tolerance by which samples may be off; the rest is for places between them.
constexpr double fit_share = 0.9;
/// A list of so many triangles is not divided to get shorter ones: two clusters take about as long
/// as one, since most of the time goes into what follows.
constexpr std::size_t short_list = 2 * cluster_size;

class Builder {
 public:
  Builder(const Caster& caster, const LatticeSurface& surface, std::span<const SupportPlane> planes,
          const Reachability* reachability, const OctreeRules& rules, const OctreeData& data)
      : caster_(caster), surface_(surface), reachability_(reachability), rules_(rules) {
    rules_.tolerance -= surface.displacement;
    fit_ = {planes, rules.band, data.value_unit, fit_share * rules_.tolerance, rules.direction};
  }

  [[nodiscard]] OctreeNode root(const Cube& cube) const {
    OctreeNode node;
    node.cube = cube;
    const ClosestPoint closest = caster_.closest(cube.middle);
    const double distance = std::abs(closest.distance);
    if (decided(node, closest.distance, closest.clearance, closest.direction)) return node;
    std::vector<std::uint32_t> triangles;
    caster_.within(cube.middle, distance + 2 * cube.radius(), triangles);
    const Candidates candidates = candidates_of(surface_, triangles, cube);
    std::optional<bool> inside;
    if (closest.clearance > cube.radius()) inside = closest.distance < 0;
    divide(node, candidates, inside, 0);
    return node;
  }

 private:
  const Caster& caster_;
  const LatticeSurface& surface_;
  const Reachability* reachability_;
  OctreeRules rules_;
  FitRules fit_;

  /// Far, deep and pruned cubes. `distance` is signed.
  bool decided(OctreeNode& node, double distance, double clearance,
               const Vector3& direction) const {
    const double reach = node.cube.radius();
    const bool one_sided = clearance > reach;
    if (one_sided && distance - reach > rules_.band.margin) {
      node.kind = OctreeKind::far;
      node.clearance = std::min(distance, clearance);
      return true;
    }
    if (one_sided && -distance - reach > rules_.band.max_depth) {
      node.kind = OctreeKind::deep;
      node.words = {pack_octahedral(direction), 0};
      return true;
    }
    if (reachability_ == nullptr) return false;
    node.rule = reachability_->cube(node.cube.middle, 2 * node.cube.half);
    if (node.rule != PruneRule::none) node.kind = OctreeKind::pruned;
    return node.rule != PruneRule::none;
  }

  void divide(OctreeNode& node, const Candidates& candidates, std::optional<bool> inside,
              int level) const {
    if (level > 0) {
      const double distance = candidates.distance();
      if (!inside && candidates.clearance() > node.cube.radius()) {
        inside = is_inside(surface_, caster_, candidates, node.cube.middle);
      }
      if (inside) {
        const Vector3 away = node.cube.middle - candidates.triangles.front().closest;
        const double sign = *inside ? -1 : 1;
        if (decided(node, sign * distance, candidates.clearance(), sign * away)) return;
      } else if (decided(node, 0, 0, Vector3::UnitZ())) {
        return;
      }
    }
    if (fits(node, candidates, inside)) return;
    if (level == rules_.levels || is_short(candidates, inside)) {
      become_list(node, candidates, inside);
      return;
    }
    node.kind = OctreeKind::split;
    node.octants = std::make_unique<std::array<OctreeNode, 8>>();
    for (std::size_t octant = 0; octant < 8; ++octant) {
      OctreeNode& part = (*node.octants)[octant];
      part.cube = node.cube.octant(octant);
      divide(part, candidates_within(surface_, candidates, part.cube), inside, level + 1);
    }
    join(node);
  }

  /// Whether one polynomial, or two, answer within the tolerance everywhere in the cube.
  bool fits(OctreeNode& node, const Candidates& candidates, std::optional<bool> inside) const {
    if (!candidates.caps.empty()) return false;
    const std::vector<CubeSample> samples =
        sample_cube(surface_, caster_, candidates, node.cube, inside);
    for (const auto& fit : {fit_one, fit_two}) {
      const std::optional<FittedMaps> fitted = fit(samples, node.cube, fit_);
      if (!fitted || !prove_maps(surface_, caster_, candidates, node.cube, inside, *fitted,
                                 fit_.planes, rules_.band, rules_.tolerance)) {
        continue;
      }
      node.kind = fitted->kind;
      for (const PackedLocalMap& map : fitted->packed) {
        node.words.insert(node.words.end(), map.words.begin(), map.words.end());
      }
      return true;
    }
    return false;
  }

  /// Whether a list is so short that dividing the cube is not worth the bytes. Beside an open side
  /// a triangle does not know its side, so there cubes are divided to know theirs.
  [[nodiscard]] bool is_short(const Candidates& candidates, std::optional<bool> inside) const {
    return candidates.triangles.size() + candidates.caps.size() <= short_list &&
           (inside || std::none_of(candidates.triangles.begin(), candidates.triangles.end(),
                                   [&](const Candidate& candidate) {
                                     return surface_.triangles[candidate.triangle].open;
                                   }));
  }

  void become_list(OctreeNode& node, const Candidates& candidates,
                   std::optional<bool> inside) const {
    node.kind = OctreeKind::list;
    node.side = !inside ? ListSide::surface : *inside ? ListSide::inside : ListSide::outside;
    const auto listed = [&](const std::vector<Candidate>& from, auto& to) {
      for (const Candidate& candidate : from) {
        to.push_back({candidate.triangle, std::max(0.0, candidate.distance - node.cube.radius())});
      }
    };
    listed(candidates.triangles, node.triangles);
    if (!inside) listed(candidates.caps, node.caps);
  }

  /// Eight octants that have nothing to say are one cube.
  static void join(OctreeNode& node) {
    const OctreeKind kind = node.octants->front().kind;
    if (kind != OctreeKind::far && kind != OctreeKind::pruned) return;
    double clearance = std::numeric_limits<double>::infinity();
    for (const OctreeNode& octant : *node.octants) {
      if (octant.kind != kind) return;
      clearance = std::min(clearance, octant.clearance - octant.cube.radius());
    }
    node.kind = kind;
    node.clearance = std::max(0.0, clearance);
    node.octants.reset();
  }
};

}  // namespace

BuiltOctree build_octree(const LatticeSurface& surface, const Caster& caster,
                         std::span<const SupportPlane> planes, const Reachability* reachability,
                         const OctreeRules& rules, const Progress& progress) {
  BuiltOctree built;
  OctreeData& data = built.data;
  data.edge = std::ldexp(rules.smallest_edge, rules.levels);
  const double around = rules.band.margin + rules.tolerance;
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
  const double root_radius = std::sqrt(3.0) * data.edge / 2;
  data.reach = std::max(rules.band.max_depth, rules.band.margin) + 2 * root_radius;
  data.value_unit = data.reach / 32000;
  data.clearance_unit = caster.diagonal() / 1e6;
  const std::size_t count = std::size_t{data.roots[0]} * data.roots[1] * data.roots[2];
  std::vector<OctreeNode> roots(count);
  const Builder builder(caster, surface, planes, reachability, rules, data);
  ProgressCounter counter(progress, "octree", count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const Vector3 at(static_cast<double>(i % data.roots[0]),
                     static_cast<double>(i / data.roots[0] % data.roots[1]),
                     static_cast<double>(i / data.roots[0] / data.roots[1]));
    roots[i] =
        builder.root({data.origin + data.edge * (at + Vector3::Constant(0.5)), data.edge / 2});
    counter.done();
  });
  write_words(roots, surface, built);
  if (built.counts.polynomials + built.counts.pairs + built.counts.lists == 0) {
    throw BakeError(ExitCode::invalid_input,
                    "nothing of the object is left to model: the probe's centre comes to no place "
                    "of its band; move the object into the workspace, or take a smaller probe");
  }
  return built;
}

}  // namespace spm::baker
