// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/outer_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/base/groups.hpp"
#include "baker/mesh/join_vertices.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/mesh_repair.hpp"
#include "baker/mesh/sliver_removal.hpp"
#include "baker/mesh/triangle_fan.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/mesh/winding_number.hpp"
#include "baker/surface/narrow_gaps.hpp"
#include "baker/surface/self_intersection.hpp"
#include "baker/surface/triangle_split.hpp"

namespace spm::baker {
namespace {

/// The winding numbers on both sides of a piece, all that lie on it included.
struct PieceWinding {
  int front = 0;  ///< where its normal points to
  int back = 0;
};

/// Of the angle between two pieces at an edge, from where on they may lie on each other.
constexpr double folded_cosine = 0.9;
/// How far from a piece its winding number is asked: a share of its width, within shares of the
/// diagonal. Rounding is far below that, and gaps that are not closed are above.
constexpr double share_of_width = 1e-3, least_offset = 1e-10, most_offset = 1e-9;
/// So many pieces of a part are asked, the largest ones, until so many of them agree with what
/// changes across them. Others lie closer to each other than that.
constexpr std::size_t most_asked = 200, enough_agree = 5;

/// What lies between pieces: of which sides it is bounded, and by how much the winding number
/// changes from one to the next.
class Cells {
 public:
  Cells(const SplitMesh& split, std::size_t count)
      : split_(split),
        pieces_(split.pieces.begin(), split.pieces.begin() + static_cast<std::ptrdiff_t>(count)),
        sides_(2 * count),
        parts_(count) {
    for_each_edge(sorted_edges(pieces_), [&](std::span<const HalfEdge> users) { join(users); });
  }

  [[nodiscard]] std::uint32_t cell(std::uint32_t side) { return sides_.of(side); }
  [[nodiscard]] std::uint32_t part(std::uint32_t piece) { return parts_.of(piece); }
  /// How much more the winding number is behind a piece.
  [[nodiscard]] int jump(std::uint32_t piece) const {
    return static_cast<int>(split_.jumps[piece]);
  }

 private:
  void join(std::span<const HalfEdge> users) {
    for (const HalfEdge& user : users.subspan(1)) parts_.join(users[0].triangle, user.triangle);
    if (users.size() == 2 && users[0].forward != users[1].forward && !may_lie_on(users)) {
      sides_.join(front(users[0].triangle), front(users[1].triangle));
      sides_.join(back(users[0].triangle), back(users[1].triangle));
      return;
    }
    const std::vector<FanLeaf> fan = triangle_fan(
        pieces_, users, [&](std::uint32_t vertex) { return split_.exact_place(vertex); });
    for (std::size_t i = 0; i < fan.size(); ++i) {
      sides_.join(ahead(fan[i].user), behind(fan[(i + 1) % fan.size()].user));
    }
  }

  /// Whether the two pieces at an edge may be folded onto each other, with rounding in mind.
  [[nodiscard]] bool may_lie_on(std::span<const HalfEdge> users) const {
    const Vector3& low = split_.points[users[0].low];
    const Vector3 along = (split_.points[users[0].high] - low).normalized();
    std::array<Vector3, 2> away;
    for (std::size_t i = 0; i < 2; ++i) {
      const Vector3 tip = split_.points[tip_of(pieces_[users[i].triangle], users[i])] - low;
      away[i] = tip - tip.dot(along) * along;
    }
    return !(away[0].dot(away[1]) < folded_cosine * away[0].norm() * away[1].norm());
  }

  const SplitMesh& split_;
  std::vector<Triangle> pieces_;
  Groups sides_;  ///< of pieces, by cell
  Groups parts_;  ///< of pieces that hang together by edges
};

/// The largest pieces of each part, part by part.
[[nodiscard]] std::vector<std::uint32_t> by_part_and_area(const SplitMesh& split, std::size_t count,
                                                          Cells& cells) {
  std::vector<double> areas(count);
  std::vector<std::uint32_t> parts(count), order(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = split.pieces[i];
    areas[i] = (split.points[b] - split.points[a]).cross(split.points[c] - split.points[a]).norm();
    parts[i] = cells.part(i);
    order[i] = i;
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t one, std::uint32_t other) {
    if (parts[one] != parts[other]) return parts[one] < parts[other];
    return areas[one] != areas[other] ? areas[one] > areas[other] : one < other;
  });
  return order;
}

/// The winding numbers in front of a piece and behind it.
[[nodiscard]] std::array<int, 2> asked_beside(const SplitMesh& split, std::uint32_t piece,
                                              const WindingNumber& winding, double diagonal) {
  const auto& [i, j, k] = split.pieces[piece];
  const Vector3 &a = split.points[i], &b = split.points[j], &c = split.points[k];
  const Vector3 twice = (b - a).cross(c - a), middle = (a + b + c) / 3;
  const double offset = std::clamp(share_of_width * std::sqrt(twice.norm()),
                                   least_offset * diagonal, most_offset * diagonal);
  const Vector3 step = offset * twice.stableNormalized();
  return {static_cast<int>(std::lround(winding.at(middle + step))),
          static_cast<int>(std::lround(winding.at(middle - step)))};
}

[[nodiscard]] int middle_of(std::vector<int> numbers) {
  const auto middle = numbers.begin() + std::ssize(numbers) / 2;
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

/// Of the first `count` pieces, which are closed: from each piece to those at its edges, by exact
/// predicates (Zhou et al. 2016), so that what is kept by them closes. Of each part that hangs
/// together `winding` is asked at a few pieces. `diagonal`: of the mesh, m.
[[nodiscard]] std::vector<PieceWinding> winding_of_pieces(const SplitMesh& split, std::size_t count,
                                                          const WindingNumber& winding,
                                                          double diagonal) {
  Cells cells(split, count);
  std::vector<CubeBins::Member> members;
  for (std::uint32_t i = 0; i < count; ++i) {
    members.emplace_back(cells.cell(front(i)), i);
    members.emplace_back(cells.cell(back(i)), i);
  }
  const CubeBins bounds(2 * count, members);
  std::vector<std::optional<int>> levels(2 * count);  // by cell, from one of its part
  const std::vector<std::uint32_t> order = by_part_and_area(split, count, cells);
  std::vector<PieceWinding> sides(count);
  for (std::size_t begin = 0; begin < order.size();) {
    const std::uint32_t part = cells.part(order[begin]);
    std::vector<std::uint32_t> reached{cells.cell(front(order[begin]))};
    levels[reached[0]] = 0;
    while (!reached.empty()) {
      const std::uint32_t cell = reached.back();
      reached.pop_back();
      for (const std::uint32_t piece : bounds.of(cell, cell)) {
        const std::uint32_t in_front = cells.cell(front(piece));
        const std::uint32_t other = cell == in_front ? cells.cell(back(piece)) : in_front;
        if (levels[other]) continue;
        levels[other] = *levels[cell] + (cell == in_front ? 1 : -1) * cells.jump(piece);
        reached.push_back(other);
      }
    }
    std::size_t end = begin, asked = 0;
    std::vector<int> bases, doubted;
    for (; end < order.size() && cells.part(order[end]) == part; ++end) {
      if (bases.size() >= enough_agree || ++asked > most_asked) continue;
      const std::uint32_t piece = order[end];
      const auto [in_front, at_back] = asked_beside(split, piece, winding, diagonal);
      (at_back - in_front == cells.jump(piece) ? bases : doubted)
          .push_back(in_front - *levels[cells.cell(front(piece))]);
    }
    const int base = middle_of(bases.empty() ? doubted : bases);
    for (; begin < end; ++begin) {
      const std::uint32_t piece = order[begin];
      sides[piece] = {base + *levels[cells.cell(front(piece))],
                      base + *levels[cells.cell(back(piece))]};
    }
  }
  return sides;
}

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
