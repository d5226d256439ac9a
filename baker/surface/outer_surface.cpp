// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/outer_surface.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "baker/mesh/winding_number.hpp"
#include "baker/surface/join_vertices.hpp"
#include "baker/surface/self_intersection.hpp"
#include "baker/surface/triangle_split.hpp"

namespace spm::baker {
namespace {

[[nodiscard]] Vector3 twice_area(std::span<const Vector3> points, const Triangle& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
}

[[nodiscard]] Vector3 centroid(std::span<const Vector3> points, const Triangle& t) {
  return (points[t[0]] + points[t[1]] + points[t[2]]) / 3;
}

/// True where a point of the triangle's plane lies within it.
[[nodiscard]] bool covers(std::span<const Vector3> points, const Triangle& t,
                          const Vector3& point) {
  const Vector3 normal = twice_area(points, t);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3& from = points[t[k]];
    if ((points[t[(k + 1) % 3]] - from).cross(point - from).dot(normal) < 0) return false;
  }
  return true;
}

/// Decides for each piece whether it bounds the solid.
class Judge {
 public:
  Judge(const Mesh& mesh, const SplitMesh& split)
      : mesh_(mesh), split_(split), winding_(mesh.vertices, mesh.triangles) {}

  [[nodiscard]] std::vector<char> bounding_pieces() const {
    std::vector<char> kept(split_.pieces.size(), 0);
    tbb::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t piece) {
      kept[piece] = bounds_solid(piece) && !repeated(piece) ? 1 : 0;
    });
    return kept;
  }

  [[nodiscard]] double winding_at(const Vector3& point) const { return winding_.at(point); }

 private:
  [[nodiscard]] bool bounds_solid(std::size_t piece) const {
    const Triangle& t = split_.pieces[piece];
    const Vector3 twice = twice_area(split_.points, t);
    const double size = twice.norm();
    const Vector3 middle = centroid(split_.points, t);
    // Close enough to have no other surface in between, and far enough to be clear of rounding.
    constexpr double kFarthest = 1e-7;
    constexpr double kNearest = 1e-10;
    const double width = std::sqrt(size);
    const double offset =
        std::clamp(1e-3 * width, kNearest * mesh_.diagonal, kFarthest * mesh_.diagonal);
    const Vector3 step = offset / size * twice;
    const double outside = winding_.at(middle + step);
    // Across a single layer the winding number steps by one, also where the mesh is open.
    const double inside =
        overlaps(split_.parents[piece]) ? winding_.at(middle - step) : outside + 1;
    return inside >= 0.5 && outside < 0.5;
  }

  using Partners = std::vector<TrianglePair>::const_iterator;

  /// First triangle that overlaps `triangle` in its plane.
  [[nodiscard]] Partners first_partner(std::uint32_t triangle) const {
    return std::lower_bound(split_.coplanar.begin(), split_.coplanar.end(),
                            TrianglePair(triangle, 0));
  }

  [[nodiscard]] bool overlaps(std::uint32_t triangle) const {
    const Partners partner = first_partner(triangle);
    return partner != split_.coplanar.end() && partner->first == triangle;
  }

  /// Of pieces that lie on one another and face the same way, only that of the first triangle
  /// stays.
  [[nodiscard]] bool repeated(std::size_t piece) const {
    const std::uint32_t parent = split_.parents[piece];
    for (Partners partner = first_partner(parent);
         partner != split_.coplanar.end() && partner->first == parent; ++partner) {
      if (partner->second > parent) continue;
      const Triangle& other = mesh_.triangles[partner->second];
      const bool same_way = twice_area(mesh_.vertices, other)
                                .dot(twice_area(mesh_.vertices, mesh_.triangles[parent])) > 0;
      if (same_way &&
          covers(mesh_.vertices, other, centroid(split_.points, split_.pieces[piece]))) {
        return true;
      }
    }
    return false;
  }

  const Mesh& mesh_;
  const SplitMesh& split_;
  WindingNumber winding_;
};

using Edge = std::array<std::uint32_t, 2>;

/// The vertices of a mesh's border, joined where a border edge joins them.
class BorderRuns {
 public:
  explicit BorderRuns(const Mesh& mesh) {
    for (const auto& [from, to] : mesh.border) {
      const std::uint32_t a = run(from);
      const std::uint32_t b = run(to);
      if (a != b) parent_[std::max(a, b)] = std::min(a, b);
    }
    std::map<std::uint32_t, double> weights;
    for (const auto& [from, to] : mesh.border) {
      centres_.try_emplace(run(from), Vector3::Zero()).first->second +=
          mesh.vertices[from] + mesh.vertices[to];
      weights[run(from)] += 2;
    }
    for (auto& [run, centre] : centres_) centre /= weights.at(run);
  }

  /// A number for the run to which a border vertex belongs.
  [[nodiscard]] std::uint32_t run(std::uint32_t vertex) {
    auto at = parent_.try_emplace(vertex, vertex).first;
    while (at->second != at->first) {
      at->second =
          parent_.at(at->second);  // halves the path for the next time: borders can be long
      at = parent_.find(at->second);
    }
    return at->first;
  }

  [[nodiscard]] const Vector3& centre(std::uint32_t run) const { return centres_.at(run); }

 private:
  std::map<std::uint32_t, std::uint32_t> parent_;
  std::map<std::uint32_t, Vector3> centres_;
};

/// Edges of the triangles of which at least one piece stays; sorted.
[[nodiscard]] std::vector<Edge> edges_that_stay(const Mesh& mesh, const SplitMesh& split,
                                                const std::vector<char>& kept) {
  std::vector<Edge> edges;
  for (std::size_t piece = 0; piece < kept.size(); ++piece) {
    if (kept[piece] == 0) continue;
    const auto& [a, b, c] = mesh.triangles[split.parents[piece]];
    edges.insert(edges.end(), {{a, b}, {b, c}, {c, a}});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Caps each run of border edges by a fan from its centroid, where a surface that stays ends there.
void add_caps(const Mesh& mesh, const Judge& judge, const std::vector<Edge>& edges,
              OuterSurface& surface) {
  // A cap represents the surface of winding number one half that closes the solid there. In a hole
  // within another part there is none.
  constexpr double kLeast = 0.05;
  constexpr double kMost = 0.95;
  struct Fan {
    std::uint32_t centre;  ///< its vertex
    CappedHole hole;
  };
  BorderRuns runs(mesh);
  std::map<std::uint32_t, Fan> fans;
  for (const Edge& edge : mesh.border) {
    const auto& [from, to] = edge;
    if (!std::binary_search(edges.begin(), edges.end(), edge)) continue;
    const std::uint32_t run = runs.run(from);
    const Vector3& centre = runs.centre(run);
    const double winding = judge.winding_at((mesh.vertices[from] + mesh.vertices[to] + centre) / 3);
    if (winding < kLeast || winding > kMost) continue;
    const auto vertex = static_cast<std::uint32_t>(surface.vertices.size());
    const auto [found, added] = fans.try_emplace(run, Fan{vertex, {.middle = centre}});
    if (added) surface.vertices.push_back(centre);
    Fan& fan = found->second;
    ++fan.hole.edges;
    const Triangle cap{to, from, fan.centre};
    const double area = twice_area(surface.vertices, cap).norm() / 2;
    if (!(area > 0)) continue;
    surface.triangles.push_back(cap);
    fan.hole.area += area;
  }
  for (const auto& [run, fan] : fans) {
    if (fan.hole.area > 0) surface.caps.push_back(fan.hole);
  }
  std::stable_sort(surface.caps.begin(), surface.caps.end(),
                   [](const CappedHole& a, const CappedHole& b) { return a.area > b.area; });
}

/// Joins vertices that are closer than this share of the diagonal, and drops the triangles that
/// this leaves without area: where surfaces cross at next to no angle, rounding leaves hairs.
constexpr double kHair = 1e-7;

void drop_hairs(const Mesh& mesh, OuterSurface& surface) {
  const std::vector<std::uint32_t> joined = join_vertices(surface.vertices, kHair * mesh.diagonal);
  const auto is_flat = [](const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  };
  for (Triangle& triangle : surface.triangles) {
    for (std::uint32_t& corner : triangle) corner = joined[corner];
  }
  const auto caps = surface.triangles.begin() + static_cast<std::ptrdiff_t>(surface.surface_count);
  surface.surface_count -=
      static_cast<std::size_t>(std::count_if(surface.triangles.begin(), caps, is_flat));
  std::erase_if(surface.triangles, is_flat);
}

/// Keeps the vertices that triangles refer to.
void compact(OuterSurface& surface) {
  std::vector<char> used(surface.vertices.size(), 0);
  for (const Triangle& triangle : surface.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = 1;
  }
  std::vector<std::uint32_t> renumbered(surface.vertices.size(), 0);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    surface.vertices[count] = surface.vertices[i];
    renumbered[i] = count++;
  }
  surface.vertices.resize(count);
  for (Triangle& triangle : surface.triangles) {
    for (std::uint32_t& corner : triangle) corner = renumbered[corner];
  }
}

}  // namespace

void split_caps(OuterSurface& surface) {
  if (surface.triangles.size() == surface.surface_count) return;
  std::vector<TrianglePair> pairs = intersecting_pairs(surface.vertices, surface.triangles);
  std::erase_if(pairs,
                [&](const TrianglePair& pair) { return pair.second < surface.surface_count; });
  if (pairs.empty()) return;
  SplitMesh split = split_triangles(surface.vertices, surface.triangles, pairs);
  surface.surface_count = static_cast<std::size_t>(
      std::lower_bound(split.parents.begin(), split.parents.end(), surface.surface_count) -
      split.parents.begin());
  surface.vertices = std::move(split.points);
  surface.triangles = std::move(split.pieces);
}

OuterSurface outer_surface(const Mesh& mesh) {
  OuterSurface surface;
  const std::vector<TrianglePair> pairs = intersecting_pairs(mesh.vertices, mesh.triangles);
  if (pairs.empty() && mesh.closed() && mesh.components == 1) {
    surface.vertices = mesh.vertices;
    surface.triangles = mesh.triangles;
    surface.surface_count = mesh.triangles.size();
    return surface;
  }
  SplitMesh split = split_triangles(mesh.vertices, mesh.triangles, pairs);
  const Judge judge(mesh, split);
  const std::vector<char> kept = judge.bounding_pieces();
  surface.vertices = split.points;
  surface.intersecting = split.split;
  for (std::size_t piece = 0; piece < kept.size(); ++piece) {
    if (kept[piece] != 0) {
      surface.triangles.push_back(split.pieces[piece]);
    } else {
      ++surface.hidden;
      surface.hidden_area += twice_area(split.points, split.pieces[piece]).norm() / 2;
    }
  }
  surface.surface_count = surface.triangles.size();
  add_caps(mesh, judge, edges_that_stay(mesh, split, kept), surface);
  split_caps(surface);
  drop_hairs(mesh, surface);
  compact(surface);
  return surface;
}

}  // namespace spm::baker
