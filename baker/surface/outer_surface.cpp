// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/outer_surface.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "baker/mesh/join_vertices.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/sliver_removal.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/mesh/winding_number.hpp"
#include "baker/surface/narrow_gaps.hpp"
#include "baker/surface/piece_winding.hpp"
#include "baker/surface/self_intersection.hpp"
#include "baker/surface/triangle_split.hpp"

namespace spm::baker {
namespace {

/// Vertices closer than this share of the diagonal are one, and triangles lower than it go: where
/// surfaces cross at next to no angle, rounding leaves hairs.
constexpr double hair = 1e-7;

/// The pieces that bound the union of the solids, and all of sheets.
[[nodiscard]] std::vector<LooseTriangle> bounding_pieces(const Mesh& mesh, const SplitMesh& split,
                                                         OuterSurface& surface) {
  const auto solids = static_cast<std::size_t>(
      std::lower_bound(split.parents.begin(), split.parents.end(), mesh.solid_triangles()) -
      split.parents.begin());
  const WindingNumber winding(mesh.vertices,
                              std::span(mesh.triangles).first(mesh.solid_triangles()));
  const std::vector<PieceWinding> sides = winding_of_pieces(split, solids, winding, mesh.diagonal);
  std::vector<LooseTriangle> loose;
  for (std::size_t piece = 0; piece < split.pieces.size(); ++piece) {
    LooseTriangle one{split.pieces[piece], piece >= solids, split.parents[piece]};
    if (!one.sheet) {
      const PieceWinding& here = sides[piece];
      if ((here.front > 0) == (here.back > 0)) {
        ++surface.hidden;
        const auto& [a, b, c] = one.corners;
        surface.hidden_area += triangle_area(split.points[a], split.points[b], split.points[c]);
        continue;
      }
      if (here.front > 0) std::swap(one.corners[1], one.corners[2]);
    }
    loose.push_back(one);
  }
  return loose;
}

[[nodiscard]] std::vector<Triangle> solids_among(const std::vector<LooseTriangle>& loose) {
  std::vector<Triangle> solids;
  for (const LooseTriangle& one : loose) {
    if (!one.sheet) solids.push_back(one.corners);
  }
  return solids;
}

/// Whether solids close where vertices within a distance, m, are one.
[[nodiscard]] bool closes(const std::vector<Vector3>& vertices, std::vector<Triangle> solids,
                          double distance) {
  const std::vector<std::uint32_t> joined = join_vertices(vertices, distance);
  for (Triangle& triangle : solids) {
    for (std::uint32_t& corner : triangle) corner = joined[corner];
  }
  const std::vector<char> open = open_vertices(vertices.size(), solids);
  return std::none_of(open.begin(), open.end(), [](char is_open) { return is_open != 0; });
}

/// Keeps vertices that triangles refer to.
void compact(std::vector<Vector3>& vertices, std::vector<Triangle>& triangles) {
  std::vector<char> used(vertices.size(), 0);
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = 1;
  }
  std::vector<std::uint32_t> renumbered(vertices.size(), 0);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    vertices[count] = vertices[i];
    renumbered[i] = count++;
  }
  vertices.resize(count);
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle) corner = renumbered[corner];
  }
}

/// Closes narrow gaps. Where what is left does not close, nor will on a lattice, the solids'
/// boundary as it was tells sides: beside triangles at open sides and those that others face.
void close_gaps(const Mesh& mesh, std::span<const TrianglePair> facing,
                std::span<const std::uint32_t> planes, double narrow, OuterSurface& surface,
                std::vector<LooseTriangle>& loose) {
  auto sides = std::make_shared<ClosedSurfaces>();
  sides->vertices = surface.vertices;
  sides->triangles = solids_among(loose);
  const SolidSide solids(sides->vertices, sides->triangles);
  Felt left = without_narrow_gaps(mesh, facing, planes, narrow, solids, surface.vertices, loose);
  surface.hidden += left.hidden;
  surface.hidden_area += left.hidden_area;
  loose = std::move(left.triangles);
  if (left.hidden == 0 || !(narrow > 0)) return;
  if (closes(surface.vertices, solids_among(loose), narrow)) return;
  // Alone, hairs may reach into the solid.
  std::erase_if(loose, [&](const LooseTriangle& one) {
    const auto& [a, b, c] = one.corners;
    return triangle_height(surface.vertices[a], surface.vertices[b], surface.vertices[c]) <=
           hair * mesh.diagonal;
  });
  const std::vector<char> open = open_vertices(surface.vertices.size(), solids_among(loose));
  std::vector<char> faced(mesh.triangles.size(), 0);
  for (const auto& [one, other] : facing) faced[planes[one]] = faced[planes[other]] = 1;
  for (const LooseTriangle& one : loose) {
    if (one.sheet) continue;
    const bool at_open = std::any_of(one.corners.begin(), one.corners.end(),
                                     [&](std::uint32_t corner) { return open[corner] != 0; });
    sides->doubtful.push_back(at_open || faced[one.parent] != 0 ? 1 : 0);
  }
  sides->gap = 1.5 * narrow;
  compact(sides->vertices, sides->triangles);
  surface.sides = std::move(sides);
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
  const SplitMesh split =
      split_triangles(mesh.vertices, mesh.triangles, pairs.crossing, mesh.solid_triangles());
  surface.intersecting = split.split;
  surface.vertices = split.points;
  std::vector<LooseTriangle> loose = bounding_pieces(mesh, split, surface);
  (void)remove_slivers(surface.vertices, hair * mesh.diagonal, loose);
  if (!pairs.facing.empty() || mesh.solid_triangles() < mesh.triangles.size()) {
    close_gaps(mesh, pairs.facing, split.planes, narrow, surface, loose);
  }
  for (const LooseTriangle& one : loose) {
    surface.triangles.push_back(one.corners);
    surface.solid_count += one.sheet ? 0 : 1;
  }
  compact(surface.vertices, surface.triangles);
  return surface;
}

OuterSurface solids_of(const OuterSurface& surface) {
  OuterSurface solids = surface;
  solids.triangles.resize(surface.solid_count);
  return solids;
}

}  // namespace spm::baker
