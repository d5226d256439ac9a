// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/lattice_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "baker/field/edge_collapse.hpp"
#include "baker/field/feature_sides.hpp"
#include "baker/field/surface_distance.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/sliver_removal.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "common/field/indexed_triangles.hpp"
#include "common/field/side_by_crossings.hpp"

namespace spm::baker {

namespace {

/// Lattice steps within a tolerance.
constexpr double steps_a_tolerance = 200;
/// Triangles are no thinner than this, where that can be.
constexpr double sliver_steps = 4;
/// The most that single precision may err, in steps, and how far a place usually is from a triangle
/// at most.
constexpr double max_single_error = 1;
constexpr double usual_reach = 16384;
/// Edges are collapsed where that moves the surface by no more than this share of the tolerance,
/// and turns no triangle by more than this (cosine) from the mean of those around.
constexpr double collapse_share = 1.0 / 16;
constexpr double collapse_cosine = 0.9962;  // 5 degrees
/// That leaves less of the tolerance to maps, which take more bytes for it. So it is done
/// only where no more than this share of the triangles is left.
constexpr double worth_collapsing = 0.6;

LatticePoint rounded(const Vector3& point, const Vector3& origin, double step) {
  LatticePoint at{};
  for (int axis = 0; axis < 3; ++axis) {
    at[static_cast<std::size_t>(axis)] =
        static_cast<std::uint32_t>(std::llround((point[axis] - origin[axis]) / step));
  }
  return at;
}

/// The least power of two, m, that keeps rounding small beside the tolerance, or the least that
/// corner_bits can count.
double lattice_step(double tolerance, double extent) {
  const double fine = std::exp2(std::floor(std::log2(tolerance / steps_a_tolerance)));
  const double coarse = std::exp2(std::ceil(std::log2(extent / (corner_mask - 2))));
  return std::max(fine, coarse);
}

Vector3 place_of(const LatticePoint& steps, const Vector3& origin, double step) {
  return origin + step * Vector3(steps[0], steps[1], steps[2]);
}

/// Of places nearest to a sheet, all are outside.
constexpr FeatureSides all_outside = [] {
  unsigned sides = 0;
  for (unsigned part = 0; part < 7; ++part) {
    sides |= pack_side(static_cast<TriangleFeature>(part), FeatureSide::outside);
  }
  return static_cast<FeatureSides>(sides);
}();

/// Turns a triangle so that its first side is the shortest.
void turn(LatticeTriangle& triangle, std::size_t by) {
  const auto old = triangle;
  triangle.sides = pack_side(TriangleFeature::face, unpack_side(old.sides, TriangleFeature::face));
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = (k + by) % 3;
    triangle.corners[k] = old.corners[from];
    triangle.steps[k] = old.steps[from];
    for (const std::size_t part : {1U, 4U}) {
      const FeatureSide side = unpack_side(old.sides, static_cast<TriangleFeature>(part + from));
      triangle.sides |= pack_side(static_cast<TriangleFeature>(part + k), side);
    }
  }
  triangle.shares = shares_of(triangle.corners);
}

std::size_t shortest_side(const std::array<Vector3, 3>& corners) {
  std::size_t shortest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if ((corners[(k + 1) % 3] - corners[k]).norm() <
        (corners[(shortest + 1) % 3] - corners[shortest]).norm()) {
      shortest = k;
    }
  }
  return shortest;
}

/// Whether single precision is off by more than a step: the rounding of the normal, which is the
/// product of the shortest side and another over the height, acts over the way to the point.
bool needs_doubles(const std::array<Vector3, 3>& rounded, double unit) {
  const auto& [a, b, c] = rounded;
  const double height = triangle_height(a, b, c);
  if (!(height > 0)) return true;
  const std::size_t shortest = shortest_side(rounded);
  const double side = (rounded[(shortest + 1) % 3] - rounded[shortest]).norm();
  const double reach = longest_side(a, b, c) / unit + usual_reach;
  return 2 * std::numeric_limits<float>::epsilon() * side / height * reach > max_single_error;
}

std::vector<LatticePoint> round_vertices(const OuterSurface& surface, LatticeSurface& lattice) {
  std::vector<LatticePoint> vertices;
  vertices.reserve(surface.vertices.size());
  for (const Vector3& vertex : surface.vertices) {
    vertices.push_back(rounded(vertex, lattice.origin, lattice.step));
    lattice.displacement =
        std::max(lattice.displacement,
                 (place_of(vertices.back(), lattice.origin, lattice.step) - vertex).norm());
  }
  return vertices;
}

LatticeTriangle triangle_of(const Triangle& corners, const std::vector<LatticePoint>& vertices,
                            const LatticeSurface& lattice) {
  LatticeTriangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.steps[k] = vertices[corners[k]];
    triangle.corners[k] = place_of(triangle.steps[k], lattice.origin, lattice.step);
  }
  const auto& [a, b, c] = triangle.corners;
  const Vector3 cross = (b - a).cross(c - a);
  if (cross.norm() > 0) triangle.normal = cross.normalized();
  return triangle;
}

void add_triangle(const LooseTriangle& loose, const std::vector<LatticePoint>& vertices,
                  LatticeSurface& lattice) {
  LatticeTriangle triangle = triangle_of(loose.corners, vertices, lattice);
  triangle.sheet = loose.sheet;
  triangle.thin = needs_doubles(triangle.corners, lattice.step);
  lattice.surface.triangles.push_back(loose.corners);
  lattice.surface.solid_count += loose.sheet ? 0 : 1;
  lattice.triangles.push_back(triangle);
}

/// Where many slivers went, the sum of what each moved is far more than the surface did.
double measured_displacement(const OuterSurface& surface, const Caster& caster,
                             const std::vector<LooseTriangle>& loose,
                             const LatticeSurface& lattice) {
  OuterSurface rounded;
  rounded.vertices = lattice.surface.vertices;
  for (const LooseTriangle& triangle : loose) {
    rounded.triangles.push_back(triangle.corners);
    rounded.solid_count += triangle.sheet ? 0 : 1;
  }
  const double enough = max_single_error * lattice.step;
  return std::max(largest_distance(rounded, caster, enough),
                  largest_distance(surface, Caster(rounded), enough));
}

/// Rounds the surfaces that tell the side, where those that are felt do not close.
void add_crossed(const ClosedSurfaces& sides, LatticeSurface& lattice) {
  std::vector<LatticePoint> vertices;
  ClosedSurfaces all;
  for (const Vector3& vertex : sides.vertices) {
    vertices.push_back(rounded(vertex, lattice.origin, lattice.step));
    all.vertices.push_back(place_of(vertices.back(), lattice.origin, lattice.step));
  }
  for (const Triangle& corners : sides.triangles) {
    LatticeTriangle triangle = triangle_of(corners, vertices, lattice);
    if (triangle.normal == Vector3::Zero()) continue;
    all.triangles.push_back(corners);
    turn(triangle, shortest_side(triangle.corners));
    lattice.crossed.push_back(triangle);
  }
  all.gap = gap_steps * lattice.step;
  const std::vector<Triangle> felt(
      lattice.surface.triangles.begin(),
      lattice.surface.triangles.begin() + static_cast<std::ptrdiff_t>(lattice.surface.solid_count));
  const std::vector<char> open = open_vertices(lattice.surface.vertices.size(), felt);
  for (const Triangle& corners : felt) {
    const bool at_open = std::any_of(corners.begin(), corners.end(),
                                     [&](std::uint32_t corner) { return open[corner] != 0; });
    all.doubtful.push_back(at_open ? 1 : 0);
  }
  lattice.surface.sides = std::make_shared<ClosedSurfaces>(std::move(all));
}

}  // namespace

LatticeSurface round_to_lattice(const OuterSurface& surface, const Caster& caster,
                                double tolerance) {
  LatticeSurface lattice;
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max()), high = -low;
  const std::vector<Vector3> none;
  for (const auto* some : {&surface.vertices, surface.sides ? &surface.sides->vertices : &none}) {
    for (const Vector3& vertex : *some) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
  }
  lattice.step = lattice_step(tolerance, (high - low).maxCoeff());
  for (int axis = 0; axis < 3; ++axis) {
    lattice.origin[axis] = lattice.step * std::floor(low[axis] / lattice.step);
  }
  const std::vector<LatticePoint> vertices = round_vertices(surface, lattice);
  for (const LatticePoint& vertex : vertices) {
    lattice.surface.vertices.push_back(place_of(vertex, lattice.origin, lattice.step));
  }
  std::vector<LooseTriangle> loose;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const bool sheet = t >= surface.solid_count;
    loose.push_back({surface.triangles[t], sheet});
  }
  const double thin = sliver_steps * lattice.step;
  const double slid = remove_slivers(lattice.surface.vertices, thin, loose);
  lattice.displacement = slid > thin ? measured_displacement(surface, caster, loose, lattice)
                                     : lattice.displacement + slid;
  lattice.displacement += max_single_error * lattice.step;
  const double still = lattice.displacement;
  std::vector<LooseTriangle> fewer = loose;
  std::vector<double> moved = collapse_edges(
      lattice.surface.vertices, caster,
      {.displacement = collapse_share * tolerance, .height = thin, .min_cosine = collapse_cosine},
      fewer);
  if (static_cast<double>(fewer.size()) < worth_collapsing * static_cast<double>(loose.size())) {
    loose = std::move(fewer);
    lattice.displacement += *std::max_element(moved.begin(), moved.end());
  } else {
    moved.clear();
  }
  for (const LooseTriangle& triangle : loose) add_triangle(triangle, vertices, lattice);
  if (surface.sides) add_crossed(*surface.sides, lattice);
  lattice.sheet_thickness = caster.sheet_thickness();
  lattice.caster = std::make_unique<Caster>(lattice.surface, lattice.sheet_thickness);
  // Sides are those of solids, beside which sheets are in the way.
  std::optional<OuterSurface> without_sheets;
  std::optional<Caster> exact_solids, rounded_solids;
  if (lattice.surface.has_sheets()) {
    without_sheets = solids_of(lattice.surface);
    exact_solids.emplace(solids_of(surface));
    rounded_solids.emplace(*without_sheets);
  }
  const OuterSurface& solids = without_sheets ? *without_sheets : lattice.surface;
  const std::vector<bool> folded = find_folded(solids.triangles);
  const std::vector<FeatureSides> sides = find_feature_sides(
      solids, {exact_solids ? *exact_solids : caster,
               rounded_solids ? *rounded_solids : *lattice.caster, tolerance, still, thin, moved});
  for (std::size_t t = 0; t < lattice.triangles.size(); ++t) {
    LatticeTriangle& triangle = lattice.triangles[t];
    triangle.sides = triangle.sheet ? all_outside : sides[t];
    triangle.folded = !triangle.sheet && folded[t];
    turn(triangle, shortest_side(triangle.corners));
  }
  return lattice;
}

}  // namespace spm::baker
