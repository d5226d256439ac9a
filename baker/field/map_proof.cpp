// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/map_proof.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "baker/field/corner_distances.hpp"

namespace spm::baker {

namespace {

constexpr int max_cubes = 4096;  ///< a proof
constexpr int max_divisions = 6;
/// Of the rounding of doubles in all that follows, m a m.
constexpr double rounding = 1e-12;
/// Facets whose normals are within this of their mean: only these bound a direction between them.
constexpr double min_cone_cosine = 0.2;
constexpr std::size_t upper_witnesses = 4;

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

Quadratic along_axes(const LocalMap& map, const SupportPlane& plane, const Cube& cube) {
  Eigen::Matrix3d turn;
  turn << plane.u.transpose(), plane.v.transpose(), -plane.n.transpose();
  Eigen::Matrix3d bend;
  bend << map.bend[0], map.bend[3] / 2, map.bend[4] / 2, map.bend[3] / 2, map.bend[1],
      map.bend[5] / 2, map.bend[4] / 2, map.bend[5] / 2, map.bend[2];
  return {cube.middle, cube.half * map.value, turn.transpose() * map.slope,
          turn.transpose() * bend * turn / cube.half};
}

/// A polynomial over a cube.
class PolynomialField : public BoundedField {
 public:
  explicit PolynomialField(const Quadratic& known) : known_(known) {}
  [[nodiscard]] FieldBound about(const Vector3& middle, double /*half*/) const override {
    return {known_.about(middle), 0};
  }

 private:
  Quadratic known_;
};

/// Bounds of what a field tells less the distance over a cube; m.
struct Interval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  void meet(const Interval& other) {
    low = std::max(low, other.low);
    high = std::min(high, other.high);
  }
  [[nodiscard]] Interval wider(double off) const { return {low - off, high + off}; }
};

/// Of a cube: the maps are within the tolerance in all of it; or they are not at a place; or that
/// is not known yet.
enum class Verdict { holds, refuted, open };

class Proof {
 public:
  Proof(const LatticeSurface& surface, const Band& band, double tolerance, OctreeKind kind,
        std::span<const BoundedField* const> fields)
      : surface_(surface), band_(band), tolerance_(tolerance), kind_(kind), fields_(fields) {}

  bool holds(const Candidates& candidates, const Cube& cube, std::optional<bool> inside,
             int divisions) {
    if (++cubes_ > max_cubes) return false;
    if (!inside && candidates.solids.distance() > cube.radius() + rounding) {
      inside = is_middle_inside(surface_, candidates, cube);
    }
    switch (judge(candidates, cube, inside)) {
      case Verdict::holds:
        return true;
      case Verdict::refuted:
        return false;
      case Verdict::open:
        break;
    }
    if (divisions == max_divisions) return false;
    const std::array<Candidates, 8> octants = candidates_in_octants(surface_, candidates, cube);
    for (std::size_t octant = 0; octant < 8; ++octant) {
      if (!holds(octants[octant], cube.octant(octant), inside, divisions + 1)) return false;
    }
    return true;
  }

 private:
  const LatticeSurface& surface_;
  Band band_;
  double tolerance_;
  OctreeKind kind_;
  std::span<const BoundedField* const> fields_;  ///< one or two
  int cubes_ = 0;

  Verdict judge(const Candidates& candidates, const Cube& cube, std::optional<bool> inside) const {
    const double distance = candidates.only_kind().distance() - felt_nearer(surface_, candidates);
    const bool side = inside ? *inside : is_middle_inside(surface_, candidates, cube);
    const double truth = side ? -distance : distance;
    std::array<FieldBound, 2> maps;
    std::array<Interval, 2> off;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      maps[k] = fields_[k]->about(cube.middle, cube.half);
    }
    if (is_off(of_both(maps[0].near.value, maps[1].near.value), truth)) return Verdict::refuted;
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      off[k].meet(by_directions(candidates, cube, maps[k].near, truth).wider(maps[k].off));
    }
    Interval whole{of_both(off[0].low, off[1].low), of_both(off[0].high, off[1].high)};
    if (within_tolerance(whole)) return Verdict::holds;
    if (inside) whole.meet(by_convexity(candidates, cube, maps, *inside));
    if (within_tolerance(whole)) return Verdict::holds;
    // Wholly beyond the band it is enough to tell so. What is told beyond the margin may be too
    // much, but not by so much that less than its share of the way beyond is left.
    const double radius = cube.radius();
    if (inside && !*inside && distance - radius >= band_.margin) {
      const double beyond = distance - radius - band_.margin;
      return verdict(beyond + whole.low >= -tolerance_ &&
                     beyond_share * whole.high <= (1 - beyond_share) * beyond + tolerance_);
    }
    if (inside && *inside && distance - radius >= band_.max_depth) {
      return verdict(-(distance - radius) + whole.high <= -band_.max_depth + tolerance_);
    }
    return Verdict::open;
  }

  static Verdict verdict(bool holds) { return holds ? Verdict::holds : Verdict::open; }

  [[nodiscard]] bool within_tolerance(const Interval& off) const {
    return off.low >= -tolerance_ && off.high <= tolerance_;
  }

  /// Whether what a place is told, m, refutes the maps, so that dividing further is in vain.
  [[nodiscard]] bool is_off(double told, double truth) const {
    const auto in_band = [&](double d) { return std::clamp(d, -band_.max_depth, band_.margin); };
    return std::abs(in_band(told) - in_band(truth)) > tolerance_ + rounding;
  }

  /// What the maps make of their two values, or where they are `turned` of the negative values; of
  /// the first alone where there is one map.
  [[nodiscard]] double of_both(double first, double second, bool turned = false) const {
    if (fields_.size() == 1) return first;
    return (kind_ == OctreeKind::least) == turned ? std::max(first, second)
                                                  : std::min(first, second);
  }

  /// Map less distance changes from the middle on at most by the largest difference of gradients,
  /// axis by axis, times half the edge. Holds across the surface.
  [[nodiscard]] Interval by_directions(const Candidates& candidates, const Cube& cube,
                                       const Quadratic& map, double truth) const {
    // The map's own gradient changes; half of that counts, since it grows from the middle on.
    const double bend = cube.half * map.bend.cwiseAbs().sum();
    const double most = most_difference(candidates, map.gradient);
    const double reach = cube.half * (most + bend) + rounding;
    const double off = map.value - truth;
    return {off - reach, off + reach};
  }

  /// At most so much do a gradient of a map and one of the distance differ, axis by axis. The
  /// distance's is of length 1, and across solids in the cone of the normals of the candidates: the
  /// normal of a facet, and at an edge or corner one between those of the facets around it.
  [[nodiscard]] double most_difference(const Candidates& candidates,
                                       const Vector3& gradient) const {
    const double of_any = gradient.lpNorm<1>() + std::sqrt(3.0);
    Vector3 axis = Vector3::Zero();
    if (!candidates.sheets.triangles.empty()) return of_any;
    for (const Candidate& candidate : candidates.solids.triangles) {
      const LatticeTriangle& triangle = surface_.triangles[candidate.triangle];
      if (triangle.folded) return of_any;
      axis += triangle.normal;
    }
    if (!(axis.norm() > 0)) return of_any;
    axis.normalize();
    double cosine = 1, most = 0;
    for (const Candidate& candidate : candidates.solids.triangles) {
      const Vector3& normal = surface_.triangles[candidate.triangle].normal;
      if (normal == Vector3::Zero()) continue;
      cosine = std::min(cosine, axis.dot(normal));
      most = std::max(most, (gradient - normal).lpNorm<1>());
    }
    if (cosine < min_cone_cosine) return of_any;
    // A direction between normals is one of their mixtures made longer, by no more than this.
    return std::min(of_any, most + std::sqrt(3.0) * (1 - cosine));
  }

  /// On one side of the surface the unsigned distance is the least of the distances of the
  /// candidates, and each of these is convex: it lies above its tangent at the middle, and below
  /// what its values at the corners give in between. Where the lesser of two maps answers, either
  /// of them may keep below a candidate, another one below the next.
  Interval by_convexity(const Candidates& candidates, const Cube& cube,
                        const std::array<FieldBound, 2>& signed_maps, bool inside) const {
    std::array<Quadratic, 2> maps;
    std::array<double, 2> low{}, rise{}, over{};
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      maps[k] = signed_maps[k].near.times(inside ? -1 : 1);
      low[k] = least_over(candidates, cube, maps[k]) - signed_maps[k].off;
      rise[k] = most_rise(maps[k], cube.half) + signed_maps[k].off;
    }
    double high = -std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : candidates.only_kind().triangles) {
      for (std::size_t k = 0; k < fields_.size(); ++k) {
        over[k] = maps[k].value - (candidate.distance - felt_nearer(surface_, candidates)) +
                  rise[k] + cube.half * (maps[k].gradient - candidate.tangent).lpNorm<1>();
      }
      high = std::max(high, of_both(over[0], over[1], inside));
    }
    const Interval bounds{of_both(low[0], low[1], inside) - rounding, high + rounding};
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
    for (std::size_t w = 0;
         candidates.witnesses.empty() && w < std::min(upper_witnesses, candidates.triangles.size());
         ++w) {
      const auto& corners = surface_.triangles[candidates.triangles[w].triangle].corners;
      bound_by(corner_distances(corners, cube.middle, cube.half));
    }
    return low;
  }
};

}  // namespace

bool prove_fields(const LatticeSurface& surface, const Candidates& candidates, const Cube& cube,
                  std::optional<bool> inside, OctreeKind kind,
                  std::span<const BoundedField* const> fields, const Band& band, double tolerance) {
  return Proof(surface, band, tolerance, kind, fields).holds(candidates, cube, inside, 0);
}

bool prove_maps(const LatticeSurface& surface, const Candidates& candidates, const Cube& cube,
                std::optional<bool> inside, const FittedMaps& fitted,
                std::span<const SupportPlane> planes, const Band& band, double tolerance) {
  std::vector<PolynomialField> maps;
  for (const LocalMap& map : fitted.maps) {
    maps.emplace_back(along_axes(map, planes[map.plane], cube));
  }
  const std::array<const BoundedField*, 2> fields{&maps.front(), &maps.back()};
  return prove_fields(surface, candidates, cube, inside, fitted.kind,
                      std::span(fields).first(maps.size()), band, tolerance);
}

}  // namespace spm::baker
