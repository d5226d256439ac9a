// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/map_proof.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "baker/field/corner_distances.hpp"
#include "baker/field/edge_bound.hpp"

namespace spm::baker {

namespace {

/// A proof may take so many cubes for each square of half the edge over the tolerance, since bounds
/// are looser in larger cubes; in all no fewer, and no more, than that.
constexpr double cubes_a_square = 64, least_cubes = 2048, most_cubes = 8192;
constexpr int max_divisions = 7;
/// A proof is given up where, after that share of its cubes, the share of the volume that is proven
/// is so many times behind the share of the cubes that are used. One in twenty of those would hold.
constexpr double slow_after = 0.0625, most_behind = 3;
constexpr int kept_divisions = 4;  ///< so many are kept for later proofs
/// What maps tell over a cube is told over its parts too where it is off by no more than this share
/// of the tolerance.
constexpr double exact_enough = 0.01;
/// Of the rounding of doubles in all that follows, m a m.
constexpr double rounding = 1e-12;
/// Facets whose normals are within this of their mean: only these bound a direction between them.
constexpr double min_cone_cosine = 0.2;

/// At the corners of the cube of that half edge around the quadratic's own middle.
CornerValues at_corners(const Quadratic& map, double half) {
  const Eigen::Matrix3d& bend = map.bend;
  const auto mixed = [&](int i, int j, const CornerValues& sign) {
    return CornerValues(half * half * (bend(i, j) + bend(j, i)) * sign);
  };
  const CornerValues x = linear_at_corners(0, Vector3::UnitX()),
                     y = linear_at_corners(0, Vector3::UnitY()),
                     z = linear_at_corners(0, Vector3::UnitZ());
  return linear_at_corners(map.value + half * half * bend.trace(), half * map.gradient) +
         mixed(0, 1, x * y) + mixed(0, 2, x * z) + mixed(1, 2, y * z);
}

/// The field of one map, or those of two of which the smaller or larger one counts, over a cube.
struct Told {
  std::array<FieldBound, 2> maps;
  std::array<const BoundedField*, 2> fields{};
  std::size_t count = 0;
  double off = 0;  ///< m: how far what they tell at the middle is from the exact value

  /// Where one map counts in all of the cube, the other one is left.
  void keep(std::size_t k) {
    maps[0] = maps[k];
    fields[0] = fields[k];
    count = 1;
  }
};

/// Bounds of what a field tells less the distance over a cube; m.
struct Interval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  void meet(const Interval& other) {
    low = std::max(low, other.low);
    high = std::min(high, other.high);
  }
};

/// The gradients of the distance over a cube: of length 1, and across solids in the cone of the
/// normals of the candidates: the normal of a facet, and at an edge or corner one between those of
/// the facets around it.
class Cone {
 public:
  Cone(const LatticeSurface& surface, const Candidates& candidates) {
    Vector3 axis = Vector3::Zero();
    if (!candidates.sheets.triangles.empty()) return;
    thread_local std::vector<Vector3> normals;
    normals.clear();
    for (const Candidate& candidate : candidates.solids.triangles) {
      const LatticeTriangle& triangle = surface.triangles[candidate.triangle];
      if (triangle.folded) return;
      if (triangle.normal == Vector3::Zero()) continue;
      // Facets of one plane follow each other.
      if (normals.empty() || normals.back() != triangle.normal) normals.push_back(triangle.normal);
      axis += triangle.normal;
    }
    if (!(axis.norm() > 0)) return;
    axis.normalize();
    double cosine = 1;
    for (const Vector3& normal : normals) cosine = std::min(cosine, axis.dot(normal));
    if (cosine < min_cone_cosine) return;
    normals_ = normals;
    beside_ = std::sqrt(3.0) * (1 - cosine);
  }

  /// At most so much do a gradient of a map and one of the distance differ, axis by axis.
  [[nodiscard]] double most_difference(const Vector3& gradient) const {
    const double of_any = gradient.lpNorm<1>() + std::sqrt(3.0);
    if (normals_.empty()) return of_any;
    double most = 0;
    for (const Vector3& normal : normals_) most = std::max(most, (gradient - normal).lpNorm<1>());
    // A direction between normals is one of their mixtures made longer, by no more than this.
    return std::min(of_any, most + beside_);
  }

 private:
  std::span<const Vector3> normals_;  ///< none where any gradient of length 1 counts
  double beside_ = 0;
};

/// Of a cube: the maps are within the tolerance in all of it; or they are not at a place; or that
/// is not known yet.
enum class Verdict { holds, refuted, open };

struct Judgement {
  Verdict verdict = Verdict::open;
  double beyond = 0;  ///< of what is open: by how much bounds are beyond the tolerance, m
};

class Proof {
 public:
  Proof(const LatticeSurface& surface, const Band& band, double tolerance, MapPair pair,
        std::span<const BoundedField* const> fields)
      : surface_(surface), band_(band), tolerance_(tolerance), pair_(pair), fields_(fields) {}

  bool holds(CandidateTree& tree) {
    ++cubes_;
    const double across = tree.cube.half / tolerance_;
    max_cubes_ =
        static_cast<int>(std::clamp(cubes_a_square * across * across, least_cubes, most_cubes));
    Told told;
    told.count = fields_.size();
    std::copy(fields_.begin(), fields_.end(), told.fields.begin());
    for (FieldBound& map : told.maps) map.off = std::numeric_limits<double>::infinity();
    const Verdict verdict = judge(tree, told).verdict;
    return verdict == Verdict::holds || (verdict == Verdict::open && holds_in_parts(tree, told, 1));
  }

 private:
  const LatticeSurface& surface_;
  Band band_;
  double tolerance_;
  MapPair pair_;
  std::span<const BoundedField* const> fields_;  ///< one or two
  int cubes_ = 0, max_cubes_ = 0;
  double proven_ = 0;  ///< share of the volume

  /// Of parts that are open the worst is divided first, so that a proof that fails does so soon.
  bool holds_in_parts(CandidateTree& tree, const Told& told, int divisions) {
    const bool holds = all_parts_hold(tree, told, divisions);
    if (divisions > kept_divisions) tree.octants.reset();
    return holds;
  }

  bool all_parts_hold(CandidateTree& tree, const Told& above, int divisions) {
    std::array<CandidateTree, 8>& parts = tree.parts(surface_);
    std::array<Told, 8> told;
    std::array<std::pair<double, std::size_t>, 8> open;
    std::size_t count = 0;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      if (++cubes_ > max_cubes_ || is_slow()) return false;
      told[octant] = above;
      const Judgement judged = judge(parts[octant], told[octant]);
      if (judged.verdict == Verdict::holds) {
        proven_ += std::ldexp(1.0, -3 * divisions);
        continue;
      }
      if (judged.verdict == Verdict::refuted || divisions == max_divisions) return false;
      open[count++] = {judged.beyond, octant};
    }
    std::stable_sort(open.begin(), open.begin() + count,
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t octant = open[k].second;
      if (!holds_in_parts(parts[octant], told[octant], divisions + 1)) return false;
    }
    return true;
  }

  /// Whether so little is proven that the rest would take many times the cubes there are. The worst
  /// comes first, so a proof may be behind by some.
  [[nodiscard]] bool is_slow() const {
    return cubes_ >= slow_after * max_cubes_ && cubes_ > most_behind * max_cubes_ * proven_;
  }

  /// Takes what is told in the cube above, and makes it what is told in this one.
  Judgement judge(CandidateTree& tree, Told& told) const {
    const Candidates& candidates = tree.candidates;
    const Cube& cube = tree.cube;
    const std::optional<bool>& inside = tree.inside;
    const double distance = candidates.only_kind().distance() - felt_nearer(surface_, candidates);
    const bool side = tree.is_middle_inside(surface_);
    const double truth = side ? -distance : distance;
    tell(cube, told);
    const Cone cone(surface_, candidates);
    const bool larger = pair_.larger;
    double value = of_both(told, told.maps[0].near.value, told.maps[1].near.value);
    EdgeBound edge;
    if (told.count == 2 && pair_.edge) {
      edge = bound_at_edge(told.maps, cube.half, larger);
      value = edge.value;
    }
    if (told.count == 2 && !edge.edge) leave_one(cube, told);
    if (is_off(value, truth, told.off)) return {Verdict::refuted};
    Interval whole = by_directions(cube, cone, told, truth);
    // An edge may be farther than both.
    if (edge.edge) (larger ? whole.high += edge.past : whole.low -= edge.past);
    if (beyond_tolerance(whole) <= 0) return {Verdict::holds};
    if (inside) tree.need_witnesses(surface_);
    if (inside && !(edge.past > tolerance_)) {
      Interval convex = by_convexity(candidates, cube, told, *inside);
      if (edge.edge) (larger ? convex.high += edge.past : convex.low -= edge.past);
      whole.meet(convex);
      if (beyond_tolerance(whole) <= 0) return {Verdict::holds};
    }
    if (edge.edge) {
      Told by_edge;
      by_edge.count = 1;
      by_edge.maps[0].near = edge.near;
      by_edge.maps[0].near.value += (edge.above - edge.below) / 2;
      by_edge.maps[0].off = (edge.above + edge.below) / 2;
      whole.meet(by_directions(cube, cone, by_edge, truth));
      if (beyond_tolerance(whole) <= 0) return {Verdict::holds};
      if (inside) whole.meet(by_convexity(candidates, cube, by_edge, *inside));
      if (beyond_tolerance(whole) <= 0) return {Verdict::holds};
    }
    // Wholly beyond the band it is enough to tell so. What is told beyond the margin may be too
    // much, but not by so much that less than its share of the way beyond is left.
    const double radius = cube.radius();
    if (inside && !*inside && distance - radius >= band_.margin) {
      const double beyond = distance - radius - band_.margin;
      if (beyond + whole.low >= -tolerance_ &&
          beyond_share * whole.high <= (1 - beyond_share) * beyond + tolerance_) {
        return {Verdict::holds};
      }
    }
    if (inside && *inside && distance - radius >= band_.max_depth &&
        -(distance - radius) + whole.high <= -band_.max_depth + tolerance_) {
      return {Verdict::holds};
    }
    return {Verdict::open, beyond_tolerance(whole)};
  }

  [[nodiscard]] double beyond_tolerance(const Interval& off) const {
    return std::max(-off.low, off.high) - tolerance_;
  }

  /// Whether what a place is told, m, refutes the maps, so that dividing further is in vain.
  [[nodiscard]] bool is_off(double told, double truth, double off) const {
    const auto in_band = [&](double d) { return std::clamp(d, -band_.max_depth, band_.margin); };
    return std::abs(in_band(told) - in_band(truth)) > tolerance_ + off + rounding;
  }

  /// What maps tell over a cube: what they do over the cube above it where that is exact enough.
  /// An edge asks for how directions turn in this cube.
  void tell(const Cube& cube, Told& told) const {
    told.off = 0;
    for (std::size_t k = 0; k < told.count; ++k) {
      FieldBound& map = told.maps[k];
      if (map.off <= exact_enough * tolerance_ && !(told.count == 2 && pair_.edge)) {
        map.near = map.near.about(cube.middle);
        told.off = std::max(told.off, map.off);
      } else {
        map = told.fields[k]->about(cube.middle, cube.half);
      }
    }
  }

  /// Of two maps leaves the one that counts, where it is the same in all of a cube.
  void leave_one(const Cube& cube, Told& told) const {
    const double reach = told.maps[0].reach(cube.half) + told.maps[1].reach(cube.half) + rounding;
    const double apart = told.maps[0].near.value - told.maps[1].near.value;
    if (std::abs(apart) > reach) told.keep((apart > 0) == pair_.larger ? 0 : 1);
  }

  /// What maps make of their two values, or where they are `turned` of the negative values; of the
  /// first alone where there is one map.
  [[nodiscard]] double of_both(const Told& told, double first, double second,
                               bool turned = false) const {
    if (told.count == 1) return first;
    return pair_.larger != turned ? std::max(first, second) : std::min(first, second);
  }

  /// Map less distance changes from the middle on at most by the largest difference of gradients,
  /// axis by axis, times half the edge. Holds across the surface.
  [[nodiscard]] Interval by_directions(const Cube& cube, const Cone& cone, const Told& told,
                                       double truth) const {
    std::array<Interval, 2> off;
    for (std::size_t k = 0; k < told.count; ++k) {
      const Quadratic& map = told.maps[k].near;
      // The map's own gradient changes; half of that counts, since it grows from the middle on.
      const double bend = cube.half * map.bend.cwiseAbs().sum();
      const double most = cone.most_difference(map.gradient);
      const double reach = cube.half * (most + bend) + rounding + told.maps[k].off;
      off[k] = {map.value - truth - reach, map.value - truth + reach};
    }
    return {of_both(told, off[0].low, off[1].low), of_both(told, off[0].high, off[1].high)};
  }

  /// On one side of the surface the unsigned distance is the least of the distances of the
  /// candidates, and each of these is convex: it lies above its tangent at the middle, and below
  /// what its values at the corners give in between. Where the lesser of two maps answers, either
  /// of them may keep below a candidate, another one below the next.
  Interval by_convexity(const Candidates& candidates, const Cube& cube, const Told& told,
                        bool inside) const {
    std::array<Quadratic, 2> maps;
    std::array<double, 2> low{}, rise{}, over{};
    for (std::size_t k = 0; k < told.count; ++k) {
      maps[k] = told.maps[k].near.times(inside ? -1 : 1);
      low[k] = least_over(candidates, cube, maps[k]) - told.maps[k].off;
      rise[k] = most_rise(maps[k], cube.half) + told.maps[k].off;
    }
    double high = -std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : candidates.only_kind().triangles) {
      for (std::size_t k = 0; k < told.count; ++k) {
        over[k] = maps[k].value - (candidate.distance - felt_nearer(surface_, candidates)) +
                  rise[k] + cube.half * (maps[k].gradient - candidate.tangent).lpNorm<1>();
      }
      high = std::max(high, of_both(told, over[0], over[1], inside));
    }
    const Interval bounds{of_both(told, low[0], low[1], inside) - rounding, high + rounding};
    return inside ? Interval{-bounds.high, -bounds.low} : bounds;
  }

  /// How far d' bend d may rise within a cube.
  static double most_rise(const Quadratic& map, double half) {
    double rise = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        rise += i == j ? std::max(0.0, map.bend(i, j)) : std::abs(map.bend(i, j));
      }
    }
    return half * half * rise;
  }

  /// A bound from below of map less unsigned distance, by the values of candidates at the corners.
  double least_over(const Candidates& all, const Cube& cube, const Quadratic& map) const {
    const CandidatesOfKind& candidates = all.only_kind();
    double bulge = 0;
    for (int i = 0; i < 3; ++i) bulge += cube.half * cube.half * std::max(0.0, map.bend(i, i));
    const CornerValues told = at_corners(map, cube.half) + felt_nearer(surface_, all);
    double low = -std::numeric_limits<double>::infinity();
    const auto bound_by = [&](const CornerValues& distances) {
      low = std::max(low, (told - distances).minCoeff() - bulge);
    };
    for (const Witness& witness : candidates.witnesses) bound_by(witness.distances);
    return low;
  }
};

}  // namespace

bool prove_fields(const LatticeSurface& surface, CandidateTree& tree, MapPair pair,
                  std::span<const BoundedField* const> fields, const Band& band, double tolerance) {
  return Proof(surface, band, tolerance, pair, fields).holds(tree);
}

}  // namespace spm::baker
