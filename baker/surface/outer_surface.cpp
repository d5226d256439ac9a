// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/outer_surface.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include "baker/mesh/join_vertices.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/winding_number.hpp"
#include "baker/surface/self_intersection.hpp"
#include "baker/surface/triangle_split.hpp"
#include "common/surface/closest_on_triangle.hpp"

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

/// Whether a triangle is no higher than a distance, m.
[[nodiscard]] bool is_lower(std::span<const Vector3> points, const Triangle& t, double height) {
  const Vector3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return twice_area(points, t).norm() <= height * longest;
}

/// Decides for each piece whether it is felt.
class Judge {
 public:
  Judge(const Mesh& mesh, const SplitMesh& split, double narrow)
      : mesh_(mesh),
        split_(split),
        narrow_(narrow),
        winding_(mesh.vertices, std::span(mesh.triangles).first(mesh.solid_triangles())) {}

  [[nodiscard]] std::vector<char> felt_pieces() const {
    std::vector<char> kept(split_.pieces.size(), 0);
    tbb::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t piece) {
      const bool sheet = split_.parents[piece] >= mesh_.solid_triangles();
      kept[piece] = is_felt(piece, sheet) && (sheet || !repeated(piece)) ? 1 : 0;
    });
    return kept;
  }

 private:
  /// Whether a piece bounds the solid, or of a sheet, whether both its sides are outside.
  [[nodiscard]] bool is_felt(std::size_t piece, bool sheet) const {
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
    // A sheet that lies on a solid, or within a narrow gap of it, is none.
    const Vector3 step = (sheet ? std::max(offset, narrow_) : offset) / size * twice;
    const double outside = winding_.at(middle + step);
    if (sheet) return outside < 0.5 && winding_.at(middle - step) < 0.5;
    // Across a single layer the winding number steps by one.
    const bool single = is_whole(piece) && !overlaps(split_.parents[piece]);
    const double inside = single ? outside + 1 : winding_.at(middle - step);
    return inside >= 0.5 && outside < 0.5 && !closed_gap(piece, middle, twice / size);
  }

  /// Whether a piece bounds a gap that is too narrow to count: another faces it, and beyond that is
  /// a solid.
  [[nodiscard]] bool closed_gap(std::size_t piece, const Vector3& middle,
                                const Vector3& normal) const {
    const std::uint32_t parent = split_.parents[piece];
    const auto partners = partners_of(split_.facing, parent);
    const bool faced = std::any_of(partners.begin(), partners.end(), [&](const TrianglePair& pair) {
      if (pair.second >= mesh_.solid_triangles()) return false;
      const Triangle& t = mesh_.triangles[pair.second];
      const Vector3 closest = closest_on_triangle(middle, mesh_.vertices[t[0]],
                                                  mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
      return (closest - middle).norm() <= 2 * narrow_;
    });
    if (!faced && !is_low(piece)) return false;
    // Also where there is another such gap behind the next wall.
    constexpr std::array<double, 3> shares{1, 0.25, 0.0625};
    return std::any_of(shares.begin(), shares.end(), [&](double share) {
      return winding_.at(middle + share * narrow_ * normal) >= 0.5;
    });
  }

  /// Whether a piece is a sliver that is left of a triangle where parts cross.
  [[nodiscard]] bool is_low(std::size_t piece) const {
    return !is_whole(piece) && is_lower(split_.points, split_.pieces[piece], narrow_);
  }
  /// Whether a triangle was not cut.
  [[nodiscard]] bool is_whole(std::size_t piece) const {
    return split_.pieces[piece] == mesh_.triangles[split_.parents[piece]];
  }

  /// Those of sorted pairs of which a triangle is the first.
  [[nodiscard]] static std::span<const TrianglePair> partners_of(
      const std::vector<TrianglePair>& pairs, std::uint32_t triangle) {
    const auto first = std::lower_bound(pairs.begin(), pairs.end(), TrianglePair(triangle, 0));
    const auto last = std::find_if(
        first, pairs.end(), [&](const TrianglePair& pair) { return pair.first != triangle; });
    return {first, last};
  }

  [[nodiscard]] bool overlaps(std::uint32_t triangle) const {
    return !partners_of(split_.coplanar, triangle).empty();
  }

  /// Of pieces that lie on one another and face the same way, only that of the first triangle
  /// stays.
  [[nodiscard]] bool repeated(std::size_t piece) const {
    const std::uint32_t parent = split_.parents[piece];
    for (const TrianglePair& pair : partners_of(split_.coplanar, parent)) {
      if (pair.second > parent) continue;
      const Triangle& other = mesh_.triangles[pair.second];
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
  double narrow_;  ///< m
  WindingNumber winding_;
};

/// Joins vertices that are closer than this share of the diagonal, and drops the triangles that
/// this leaves without area: where surfaces cross at next to no angle, rounding leaves hairs.
constexpr double kHair = 1e-7;

template <class IsGone>
void drop(OuterSurface& surface, std::vector<std::uint32_t>& parents, const IsGone& is_gone) {
  std::size_t kept = 0, solids = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (is_gone(surface.triangles[t])) continue;
    solids += t < surface.solid_count ? 1 : 0;
    surface.triangles[kept] = surface.triangles[t];
    parents[kept++] = parents[t];
  }
  surface.triangles.resize(kept);
  parents.resize(kept);
  surface.solid_count = solids;
}

void join_hairs(const Mesh& mesh, OuterSurface& surface, std::vector<std::uint32_t>& parents) {
  const std::vector<std::uint32_t> joined = join_vertices(surface.vertices, kHair * mesh.diagonal);
  for (Triangle& triangle : surface.triangles) {
    for (std::uint32_t& corner : triangle) corner = joined[corner];
  }
  drop(surface, parents,
       [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

/// Drops hairs that are longer: alone they may reach into the solid.
void drop_hairs(const Mesh& mesh, OuterSurface& surface, std::vector<std::uint32_t>& parents) {
  drop(surface, parents,
       [&](const Triangle& t) { return is_lower(surface.vertices, t, kHair * mesh.diagonal); });
}

/// The vertices of sides that the solids' triangles pass more often one way than the other, where
/// vertices within a distance, m, are one.
[[nodiscard]] std::vector<std::uint32_t> open_vertices(const OuterSurface& surface,
                                                       double distance) {
  std::vector<std::uint32_t> joined(surface.vertices.size());
  std::iota(joined.begin(), joined.end(), 0U);
  if (distance > 0) joined = join_vertices(surface.vertices, distance);
  std::vector<Triangle> solids(
      surface.triangles.begin(),
      surface.triangles.begin() + static_cast<std::ptrdiff_t>(surface.solid_count));
  for (Triangle& triangle : solids) {
    for (std::uint32_t& corner : triangle) corner = joined[corner];
  }
  std::vector<std::uint32_t> open;
  for_each_edge(sorted_edges(solids), [&](std::span<const HalfEdge> users) {
    const auto forward = std::count_if(users.begin(), users.end(),
                                       [](const HalfEdge& user) { return user.forward; });
    if (users[0].low == users[0].high || 2 * forward == std::ssize(users)) return;
    open.insert(open.end(), {users[0].low, users[0].high});
  });
  return open;
}

/// Keeps all of the mesh's solids to tell sides, and says beside which triangles they must: those
/// at open sides, and those that others lie along.
void keep_sides(const Mesh& mesh, double narrow, const SplitMesh& split,
                const std::vector<std::uint32_t>& parents, OuterSurface& surface) {
  std::vector<char> open(surface.vertices.size(), 0);
  for (const std::uint32_t vertex : open_vertices(surface, 0)) open[vertex] = 1;
  std::vector<char> along(mesh.triangles.size(), 0);
  for (const auto* pairs : {&split.facing, &split.coplanar}) {
    for (const TrianglePair& pair : *pairs) along[pair.first] = 1;
  }
  auto sides = std::make_shared<ClosedSurfaces>();
  sides->vertices = mesh.vertices;
  sides->triangles.assign(
      mesh.triangles.begin(),
      mesh.triangles.begin() + static_cast<std::ptrdiff_t>(mesh.solid_triangles()));
  sides->gap = 1.5 * narrow;
  for (std::size_t t = 0; t < surface.solid_count; ++t) {
    const Triangle& corners = surface.triangles[t];
    const bool at_open = std::any_of(corners.begin(), corners.end(),
                                     [&](std::uint32_t corner) { return open[corner] != 0; });
    sides->doubtful.push_back(at_open || along[parents[t]] != 0 ? 1 : 0);
  }
  surface.sides = std::move(sides);
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

OuterSurface outer_surface(const Mesh& mesh, double narrow) {
  OuterSurface surface;
  MeetingPairs pairs = meeting_pairs(mesh.vertices, mesh.triangles, narrow, mesh.solid_triangles());
  // Sheets may cross one another as they are.
  std::erase_if(pairs.crossing,
                [&](const TrianglePair& pair) { return pair.first >= mesh.solid_triangles(); });
  if (pairs.crossing.empty() && pairs.facing.empty() && mesh.closed() && mesh.components == 1) {
    surface.vertices = mesh.vertices;
    surface.triangles = mesh.triangles;
    surface.solid_count = mesh.triangles.size();
    return surface;
  }
  SplitMesh split = split_triangles(mesh.vertices, mesh.triangles, pairs);
  const std::vector<char> kept = Judge(mesh, split, narrow).felt_pieces();
  surface.vertices = split.points;
  std::vector<std::uint32_t> parents;
  surface.intersecting = split.split;
  for (std::size_t piece = 0; piece < kept.size(); ++piece) {
    if (kept[piece] != 0) {
      surface.triangles.push_back(split.pieces[piece]);
      parents.push_back(split.parents[piece]);
      surface.solid_count += split.parents[piece] < mesh.solid_triangles() ? 1 : 0;
    } else {
      ++surface.hidden;
      surface.hidden_area += twice_area(split.points, split.pieces[piece]).norm() / 2;
    }
  }
  join_hairs(mesh, surface, parents);
  // The lattice joins what a narrow gap left open.
  if (!open_vertices(surface, 0).empty() &&
      !(narrow > 0 && open_vertices(surface, narrow).empty())) {
    drop_hairs(mesh, surface, parents);
    keep_sides(mesh, narrow, split, parents, surface);
  }
  compact(surface);
  return surface;
}

OuterSurface solids_of(const OuterSurface& surface) {
  OuterSurface solids = surface;
  solids.triangles.resize(surface.solid_count);
  return solids;
}

}  // namespace spm::baker
