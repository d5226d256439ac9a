// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/outer_surface.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "baker/mesh/join_vertices.hpp"
#include "baker/mesh/winding_number.hpp"
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
    const Vector3 step = offset / size * twice;
    const double outside = winding_.at(middle + step);
    if (sheet) return outside < 0.5 && winding_.at(middle - step) < 0.5;
    // Across a single layer the winding number steps by one.
    const double inside =
        overlaps(split_.parents[piece]) ? winding_.at(middle - step) : outside + 1;
    return inside >= 0.5 && outside < 0.5 && !closed_gap(piece, middle, twice / size);
  }

  /// Whether a piece bounds a gap that is too narrow to count: another faces it, and beyond that is
  /// a solid.
  [[nodiscard]] bool closed_gap(std::size_t piece, const Vector3& middle,
                                const Vector3& normal) const {
    const std::uint32_t parent = split_.parents[piece];
    const auto partners = partners_of(split_.facing, parent);
    const bool faced = std::any_of(partners.begin(), partners.end(), [&](const TrianglePair& pair) {
      return covers(mesh_.vertices, mesh_.triangles[pair.second], middle);
    });
    return faced && winding_.at(middle + narrow_ * normal) >= 0.5;
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

void drop_hairs(const Mesh& mesh, OuterSurface& surface) {
  const std::vector<std::uint32_t> joined = join_vertices(surface.vertices, kHair * mesh.diagonal);
  const auto is_flat = [](const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  };
  for (Triangle& triangle : surface.triangles) {
    for (std::uint32_t& corner : triangle) corner = joined[corner];
  }
  const auto sheets = surface.triangles.begin() + static_cast<std::ptrdiff_t>(surface.solid_count);
  surface.solid_count -=
      static_cast<std::size_t>(std::count_if(surface.triangles.begin(), sheets, is_flat));
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

OuterSurface outer_surface(const Mesh& mesh, double narrow) {
  OuterSurface surface;
  MeetingPairs pairs = meeting_pairs(mesh.vertices, mesh.triangles, narrow);
  // Sheets may cross one another as they are.
  std::erase_if(pairs.crossing,
                [&](const TrianglePair& pair) { return pair.first >= mesh.solid_triangles(); });
  std::erase_if(pairs.facing,
                [&](const TrianglePair& pair) { return pair.second >= mesh.solid_triangles(); });
  if (pairs.crossing.empty() && pairs.facing.empty() && mesh.closed() && mesh.components == 1) {
    surface.vertices = mesh.vertices;
    surface.triangles = mesh.triangles;
    surface.solid_count = mesh.triangles.size();
    return surface;
  }
  SplitMesh split = split_triangles(mesh.vertices, mesh.triangles, pairs);
  const std::vector<char> kept = Judge(mesh, split, narrow).felt_pieces();
  surface.vertices = split.points;
  surface.intersecting = split.split;
  for (std::size_t piece = 0; piece < kept.size(); ++piece) {
    if (kept[piece] != 0) {
      surface.triangles.push_back(split.pieces[piece]);
      surface.solid_count += split.parents[piece] < mesh.solid_triangles() ? 1 : 0;
    } else {
      ++surface.hidden;
      surface.hidden_area += twice_area(split.points, split.pieces[piece]).norm() / 2;
    }
  }
  drop_hairs(mesh, surface);
  compact(surface);
  return surface;
}

OuterSurface solids_of(const OuterSurface& surface) {
  OuterSurface solids = surface;
  solids.triangles.resize(surface.solid_count);
  return solids;
}

}  // namespace spm::baker
