// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/smooth/mesh_refine.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "baker/base/bake_error.hpp"

namespace spm::baker {
namespace {

/// Edges that turn by less than this, rad, may be replaced by the other diagonal of their two
/// triangles. That moves the surface by less than a millionth of their length.
constexpr double flat_turn = 1e-6;
/// The difference that rounding leaves between two equally good diagonals.
constexpr double toss_up = 1e-9;
constexpr int flip_rounds = 3;  // between two rounds of halving

/// Space divided into numbered cubes.
class Cells {
 public:
  Cells(const Vector3& low, double edge) : low_(low), edge_(edge) {}

  /// The cube of a point. There is room for some cubes below it. No coordinate may be below the
  /// lowest.
  [[nodiscard]] std::array<std::int64_t, 3> of(const Vector3& point) const {
    const Vector3 cells = (point - low_) / edge_;
    return {static_cast<std::int64_t>(cells.x()) + 4, static_cast<std::int64_t>(cells.y()) + 4,
            static_cast<std::int64_t>(cells.z()) + 4};
  }
  [[nodiscard]] static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return (static_cast<std::uint64_t>(x) << 42U) | (static_cast<std::uint64_t>(y) << 21U) |
           static_cast<std::uint64_t>(z);
  }

 private:
  Vector3 low_;
  double edge_;
};

/// The space around some edges, in cubes: everything within the reach of an edge is in a marked
/// cube.
class Zones {
 public:
  Zones(const Vector3& low, double distance) : cell_(distance / 2), cells_(low, cell_) {}

  void add(const Vector3& from, const Vector3& to) {
    // Marks are half a cell apart, so that every point of the edge is at most a quarter of a cell
    // from one.
    const double steps = std::max(1.0, std::ceil(2 * (to - from).norm() / cell_));
    for (double i = 0; i <= steps; ++i) {
      const std::array<std::int64_t, 3> at = cells_.of(from + i / steps * (to - from));
      if (marks_.insert(Cells::key(at[0], at[1], at[2])).second) mark_about(at);
    }
  }

  /// True for every edge that comes near a marked place, and for edges that are long compared with
  /// a cell.
  [[nodiscard]] bool near(const Vector3& from, const Vector3& to) const {
    const std::array<std::int64_t, 3> low = cells_.of(from.cwiseMin(to));
    const std::array<std::int64_t, 3> high = cells_.of(from.cwiseMax(to));
    constexpr std::int64_t max_cells = 64;
    if ((high[0] - low[0] + 1) * (high[1] - low[1] + 1) * (high[2] - low[2] + 1) > max_cells) {
      return !near_.empty();
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          if (near_.contains(Cells::key(x, y, z))) return true;
        }
      }
    }
    return false;
  }

 private:
  /// Marks the cells with a point that is within the reach plus a quarter of a cell of a point of
  /// this one.
  void mark_about(const std::array<std::int64_t, 3>& at) {
    constexpr std::int64_t farthest = 3;
    constexpr double distance_in_cells = 2.25;
    const auto gap2 = [](std::int64_t offset) {
      const auto between = static_cast<double>(std::max<std::int64_t>(0, std::abs(offset) - 1));
      return between * between;
    };
    for (std::int64_t x = -farthest; x <= farthest; ++x) {
      for (std::int64_t y = -farthest; y <= farthest; ++y) {
        for (std::int64_t z = -farthest; z <= farthest; ++z) {
          if (gap2(x) + gap2(y) + gap2(z) > distance_in_cells * distance_in_cells) continue;
          near_.insert(Cells::key(at[0] + x, at[1] + y, at[2] + z));
        }
      }
    }
  }

  double cell_;
  Cells cells_;
  std::unordered_set<std::uint64_t> marks_;
  std::unordered_set<std::uint64_t> near_;
};

/// Points that keep their distance from each other.
class SpacedPoints {
 public:
  SpacedPoints(const Vector3& low, double spacing) : spacing_(spacing), cells_(low, spacing) {}

  /// Adds a point unless it is nearer to another one than the spacing. Returns whether it was
  /// added.
  bool add(const Vector3& point) {
    const std::array<std::int64_t, 3> at = cells_.of(point);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto found = points_.find(Cells::key(at[0] + x, at[1] + y, at[2] + z));
          if (found == points_.end()) continue;
          for (const Vector3& other : found->second) {
            if ((other - point).norm() < spacing_) return false;
          }
        }
      }
    }
    points_[Cells::key(at[0], at[1], at[2])].push_back(point);
    return true;
  }

 private:
  double spacing_;
  Cells cells_;
  std::unordered_map<std::uint64_t, std::vector<Vector3>> points_;
};

Vector3 lowest(const SurfaceMesh& surface_mesh) {
  Vector3 low = surface_mesh.vertices.front();
  for (const Vector3& vertex : surface_mesh.vertices) low = low.cwiseMin(vertex);
  return low;
}

Zones zones_about(const SurfaceMesh& surface_mesh, const EdgeChoice& choice, double distance) {
  Zones zones(lowest(surface_mesh), distance);
  for (const MeshEdge& edge : edges_of(surface_mesh).edges) {
    if (choice(edge))
      zones.add(surface_mesh.vertices[edge.ends[0]], surface_mesh.vertices[edge.ends[1]]);
  }
  return zones;
}

constexpr std::uint32_t whole = 0xFFFFFFFF;  // an edge that stays as it is

/// Cuts a triangle at those middles of its sides that exist.
void split(const SurfaceMesh& surface_mesh, const Triangle& t,
           const std::array<std::uint32_t, 3>& middle, std::vector<Triangle>& pieces) {
  const auto halved = [&](std::size_t k) { return middle[k] != whole; };
  const int count = (halved(0) ? 1 : 0) + (halved(1) ? 1 : 0) + (halved(2) ? 1 : 0);
  if (count == 0) {
    pieces.push_back(t);
    return;
  }
  if (count == 3) {
    pieces.insert(pieces.end(), {{t[0], middle[0], middle[2]},
                                 {middle[0], t[1], middle[1]},
                                 {middle[2], middle[1], t[2]},
                                 {middle[0], middle[1], middle[2]}});
    return;
  }
  // Turned so that either side 0 is the only one that is cut, or side 2 is the only one that is
  // not.
  std::size_t turn = 0;
  while (count == 1 ? !halved(turn) : halved((turn + 2) % 3)) ++turn;
  const std::uint32_t a = t[turn];
  const std::uint32_t b = t[(turn + 1) % 3];
  const std::uint32_t c = t[(turn + 2) % 3];
  const std::uint32_t ab = middle[turn];
  if (count == 1) {
    pieces.insert(pieces.end(), {{a, ab, c}, {ab, b, c}});
    return;
  }
  const std::uint32_t bc = middle[(turn + 1) % 3];
  pieces.push_back({ab, b, bc});
  const auto distance2 = [&](std::uint32_t p, std::uint32_t q) {
    return (surface_mesh.vertices[p] - surface_mesh.vertices[q]).squaredNorm();
  };
  if (distance2(a, bc) <= distance2(ab, c)) {
    pieces.insert(pieces.end(), {{a, ab, bc}, {a, bc, c}});
  } else {
    pieces.insert(pieces.end(), {{a, ab, c}, {ab, bc, c}});
  }
}

/// True for an edge that the shape of the surface needs.
bool is_rigid(const MeshEdge& edge) {
  return edge.triangles != 2 || !edge.paired || edge.turn > flat_turn;
}

/// Halves long edges near the zones once. These are the rigid edges, or those of the others whose
/// middles keep their distance, since flips make the rest shorter. False where there was none.
bool halve(SurfaceMesh& surface_mesh, const Zones& zones, double longest, bool rigid) {
  const MeshEdges edges = edges_of(surface_mesh);
  std::vector<std::pair<double, std::uint32_t>> lengths;
  for (std::uint32_t i = 0; i < edges.edges.size(); ++i) {
    const MeshEdge& edge = edges.edges[i];
    if (is_rigid(edge) != rigid) continue;
    const Vector3& from = surface_mesh.vertices[edge.ends[0]];
    const Vector3& to = surface_mesh.vertices[edge.ends[1]];
    const double length = (to - from).norm();
    if (length > longest && zones.near(from, to)) lengths.emplace_back(-length, i);
  }
  std::sort(lengths.begin(), lengths.end());
  SpacedPoints spaced(lowest(surface_mesh), longest / 2);
  std::vector<std::uint32_t> middles(edges.edges.size(), whole);
  std::size_t halved = 0;
  for (const auto& [length, index] : lengths) {
    const auto& [from, to] = edges.edges[index].ends;
    const Vector3 middle = (surface_mesh.vertices[from] + surface_mesh.vertices[to]) / 2;
    if (!rigid && !spaced.add(middle)) continue;
    middles[index] = static_cast<std::uint32_t>(surface_mesh.vertices.size());
    surface_mesh.vertices.push_back(middle);
    ++halved;
  }
  if (halved == 0) return false;
  std::vector<Triangle> pieces;
  pieces.reserve(surface_mesh.triangles.size() + 2 * halved);
  for (std::size_t i = 0; i < surface_mesh.triangles.size(); ++i) {
    const auto& sides = edges.of_sides[i];
    split(surface_mesh, surface_mesh.triangles[i],
          {middles[sides[0]], middles[sides[1]], middles[sides[2]]}, pieces);
  }
  surface_mesh.triangles = std::move(pieces);
  return true;
}

/// Take two triangles over an edge (a, b) with the opposite corners p and q. True where their other
/// diagonal makes less pointed triangles: the angles at p and q together are more than pi
/// (Delaunay).
bool better_flipped(const SurfaceMesh& surface_mesh, std::uint32_t a, std::uint32_t b,
                    std::uint32_t p, std::uint32_t q) {
  const auto arms = [&](std::uint32_t corner) {
    const Vector3 to_a = surface_mesh.vertices[a] - surface_mesh.vertices[corner];
    const Vector3 to_b = surface_mesh.vertices[b] - surface_mesh.vertices[corner];
    return std::pair(to_a.cross(to_b).norm(), to_a.dot(to_b));
  };
  const auto [sine_p, cosine_p] = arms(p);
  const auto [sine_q, cosine_q] = arms(q);
  const double size = std::hypot(sine_p, cosine_p) * std::hypot(sine_q, cosine_q);
  return sine_p * cosine_q + cosine_p * sine_q < -toss_up * size;
}

/// Replaces flat edges by better ones, at most one for each triangle. False where there was none.
bool flip(SurfaceMesh& surface_mesh) {
  const MeshEdges edges = edges_of(surface_mesh);
  std::vector<std::uint32_t> first(edges.edges.size(), whole);
  std::vector<char> used(surface_mesh.triangles.size(), 0);
  bool flipped = false;
  for (std::uint32_t side = 0; side < 3 * surface_mesh.triangles.size(); ++side) {
    const std::uint32_t index = edges.of_sides[side / 3][side % 3];
    if (is_rigid(edges.edges[index])) continue;
    if (first[index] == whole) {
      first[index] = side;
      continue;
    }
    const std::uint32_t one = first[index] / 3, other = side / 3;
    if (used[one] != 0 || used[other] != 0) continue;
    const Triangle t = surface_mesh.triangles[one];
    const std::uint32_t a = t[first[index] % 3], b = t[(first[index] % 3 + 1) % 3];
    const std::uint32_t p = t[(first[index] % 3 + 2) % 3];
    const std::uint32_t q = surface_mesh.triangles[other][(side % 3 + 2) % 3];
    if (p == q || !better_flipped(surface_mesh, a, b, p, q)) continue;
    surface_mesh.triangles[one] = {a, q, p};
    surface_mesh.triangles[other] = {q, b, p};
    used[one] = used[other] = 1;
    flipped = true;
  }
  return flipped;
}

}  // namespace

SurfaceMesh refined(SurfaceMesh surface_mesh, const EdgeChoice& choice, double longest,
                    double distance, std::size_t max_triangles) {
  if (surface_mesh.triangles.empty()) return surface_mesh;
  const Zones zones = zones_about(surface_mesh, choice, distance);
  // Edges across a long and narrow strip become short by flips, once the strip's borders are
  // halved.
  for (const bool rigid : {true, false}) {
    while (halve(surface_mesh, zones, longest, rigid)) {
      if (surface_mesh.triangles.size() > max_triangles) {
        throw BakeError(ExitCode::usage,
                        "--smooth: a kernel this small cuts the surface into more than " +
                            std::to_string(max_triangles / 1000000) +
                            " million triangles; ask for a larger one");
      }
      for (int round = 0; round < flip_rounds && flip(surface_mesh); ++round) {
      }
    }
  }
  return surface_mesh;
}

}  // namespace spm::baker
