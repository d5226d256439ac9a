// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_repair.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "baker/mesh/mesh_cells.hpp"
#include "baker/mesh/mesh_duplicates.hpp"
#include "baker/mesh/mesh_lids.hpp"
#include "baker/mesh/mesh_orient.hpp"
#include "baker/mesh/mesh_seams.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr std::uint32_t kNone = UINT32_MAX;
/// Borders that are nearer than this share of the diagonal are held apart by rounding alone, and
/// parts that are no thicker are flat.
constexpr double seam_share = 1e-6;

[[nodiscard]] Kernel::Point_3 exact_point(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

/// Keeps the first of equal points and renumbers the triangles. Returns how many points were
/// dropped.
std::size_t merge_equal_points(PolygonSoup& soup) {
  std::vector<std::uint32_t> order(soup.points.size());
  std::iota(order.begin(), order.end(), 0U);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vector3& p = soup.points[a];
    const Vector3& q = soup.points[b];
    return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
  });
  std::vector<std::uint32_t> first(soup.points.size());
  std::size_t merged = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && soup.points[order[i]] == soup.points[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
    merged += same ? 1U : 0U;
  }
  for (Triangle& triangle : soup.triangles) {
    for (std::uint32_t& corner : triangle) corner = first[corner];
  }
  return merged;
}

template <class IsFlat>
void drop_flat(std::vector<Triangle>& triangles, Counted& dropped, const IsFlat& is_flat) {
  std::erase_if(triangles, [&](const Triangle& t) {
    const bool flat = is_flat(t);
    if (flat) dropped.add(1, t[0]);
    return flat;
  });
}

void drop_repeated_corners(std::vector<Triangle>& triangles, Counted& dropped) {
  drop_flat(triangles, dropped,
            [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

void drop_zero_area(const std::vector<Vector3>& points, std::vector<Triangle>& triangles,
                    Counted& dropped) {
  drop_flat(triangles, dropped,
            [&](const Triangle& t) { return collinear(points[t[0]], points[t[1]], points[t[2]]); });
}

/// Keeps the referenced points in their order and renumbers triangles.
void compact(const std::vector<Vector3>& points, Mesh& mesh) {
  std::vector<std::uint32_t> renumbered(points.size(), kNone);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) renumbered[corner] = 0;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (renumbered[i] == kNone) continue;
    renumbered[i] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(points[i]);
  }
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = renumbered[corner];
  }
}

/// The diagonal of the box around all triangles.
[[nodiscard]] double extent_of(const PolygonSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : soup.triangles) {
    for (const std::uint32_t corner : triangle) box.extend(soup.points[corner]);
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

/// What the rules found and changed.
struct Changes {
  std::size_t merged = 0;
  Seams seams;
  Counted dropped;  ///< without area, or copies
  Counted inner;
  Orientation orientation;

  /// The edges of the file's surface that are open.
  [[nodiscard]] const Counted& border() const {
    const bool seamless = seams.welded.count == 0 && seams.split.count == 0;
    return seamless ? orientation.border_edges : seams.border_edges;
  }
};

void describe(const std::vector<Vector3>& points, const Changes& changes, Mesh& mesh) {
  const auto note = [&mesh](std::uint64_t count, const char* one, const char* many,
                            const char* what) {
    mesh.notes.push_back(std::to_string(count) + " " + (count == 1 ? one : many) + what);
  };
  const auto find = [&](FindingKind kind, std::uint64_t count, const Vector3& place,
                        const char* one, const char* many, const char* what) {
    if (count == 0) return;
    note(count, one, many, what);
    mesh.findings.push_back({kind, count, mesh.notes.back(), place});
  };
  const auto mended = [&](const Counted& counted, const char* one, const char* many,
                          const char* what, FindingKind kind = FindingKind::repaired) {
    find(kind, counted.count, points[counted.vertex], one, many, what);
  };
  if (changes.merged > 0) {
    note(changes.merged, "vertex", "vertices", " merged with another at the same place.");
  }
  mended(changes.seams.welded, "vertex", "vertices",
         " of the border welded to others within a millionth of the diagonal.");
  mended(changes.seams.split, "triangle", "triangles",
         " divided at vertices of others that lie on their edges.");
  mended(changes.dropped, "triangle", "triangles",
         " dropped that had no area or lay on another with the same corners.");
  mended(changes.inner, "triangle", "triangles",
         " dropped that only divide a part's inside, where nothing reaches them.");
  const Orientation& orientation = changes.orientation;
  mended(orientation.flipped, "triangle", "triangles", " reversed to agree with the neighbours.");
  mended(orientation.inverted, "part that was", "parts that were",
         " inside out turned, so that normals point out of the solid.");
  mended(orientation.unorientable, "edge joins", "edges join",
         " triangles that cannot agree on an outside (a one-sided strip).",
         FindingKind::nonmanifold);
  mended(orientation.nonmanifold_edges, "edge is", "edges are",
         " shared by more than two triangles.", FindingKind::nonmanifold);
  mended(changes.border(), "edge is", "edges are", " open: no triangle continues beyond.",
         FindingKind::open);
  find(FindingKind::lids, mesh.lids.size(),
       mesh.lids.empty() ? Vector3::Zero() : mesh.lids.front().middle, "small hole", "small holes",
       " closed by a lid, which is felt like the rest of the surface.");
  const Triangle* sheet =
      mesh.sheet_triangles > 0 ? &mesh.triangles[mesh.solid_triangles()] : nullptr;
  find(FindingKind::sheets, mesh.sheets, sheet != nullptr ? points[(*sheet)[0]] : Vector3::Zero(),
       "part is open and taken for a sheet, which is",
       "parts are open and taken for sheets, which are", " felt from both sides.");
}

}  // namespace

bool collinear(const Vector3& a, const Vector3& b, const Vector3& c) {
  return CGAL::collinear(exact_point(a), exact_point(b), exact_point(c));
}

void repair(PolygonSoup soup, Mesh& mesh) {
  mesh.file_vertices = soup.points.size();
  mesh.file_triangles = soup.triangles.size();
  Changes changes;
  changes.merged = merge_equal_points(soup);
  drop_repeated_corners(soup.triangles, changes.dropped);
  const double seam = seam_share * extent_of(soup);
  changes.seams = join_seams(soup.points, seam, soup.triangles);
  const Counted copies = drop_duplicates(soup.triangles);
  changes.dropped.add(copies.count, copies.vertex);
  changes.inner = drop_inner_faces(soup.points, soup.triangles);
  // Triangles without area are dropped last: until then they connect their neighbours.
  Orientation& orientation = changes.orientation = orient(soup.points, soup.triangles);
  const Lids lids = add_lids(soup.points, mesh.open_as, seam, soup.triangles);
  std::vector<Triangle> sheets;
  std::vector<std::uint32_t> parts;  // of solids
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    (lids.sheet[t] != 0 ? sheets : mesh.triangles).push_back(soup.triangles[t]);
    if (lids.sheet[t] == 0) parts.push_back(lids.parts[t]);
  }
  if (!lids.holes.empty()) {
    const Counted inverted = turn_parts(soup.points, parts, mesh.triangles);
    orientation.inverted.add(inverted.count, inverted.vertex);
  }
  const auto first = mesh.triangles.end() - static_cast<std::ptrdiff_t>(lids.added);
  std::vector<Triangle> covers(first, mesh.triangles.end());
  mesh.triangles.erase(first, mesh.triangles.end());
  for (std::vector<Triangle>* some : {&mesh.triangles, &covers, &sheets}) {
    drop_zero_area(soup.points, *some, changes.dropped);
  }
  mesh.lid_triangles = covers.size();
  mesh.sheet_triangles = sheets.size();
  mesh.triangles.insert(mesh.triangles.end(), covers.begin(), covers.end());
  mesh.triangles.insert(mesh.triangles.end(), sheets.begin(), sheets.end());
  mesh.components = orientation.components;
  mesh.inverted_components = static_cast<std::uint32_t>(orientation.inverted.count);
  mesh.dropped_triangles = changes.dropped.count;
  mesh.copies = copies.count;
  mesh.welded = changes.seams.welded.count;
  mesh.border_edges = changes.border().count;
  mesh.lids = lids.holes;
  mesh.sheets = lids.sheets;
  if (!mesh.triangles.empty()) describe(soup.points, changes, mesh);
  compact(soup.points, mesh);
}

}  // namespace spm::baker
