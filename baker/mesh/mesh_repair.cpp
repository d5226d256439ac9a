// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_repair.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "baker/base/groups.hpp"
#include "baker/mesh/join_vertices.hpp"
#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/mesh_lids.hpp"
#include "baker/mesh/mesh_orient.hpp"
#include "baker/mesh/triangle_fan.hpp"

namespace spm::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Borders that are nearer than this share of the diagonal are held apart by rounding alone, and
/// parts that are no thicker are flat.
constexpr double seam_share = 1e-6;

[[nodiscard]] Kernel::Point_3 plain_point(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

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

[[nodiscard]] bool repeats_corner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

template <class IsFlat>
void drop_flat(std::vector<Triangle>& triangles, Counted& dropped, const IsFlat& is_flat) {
  std::erase_if(triangles, [&](const Triangle& t) {
    const bool flat = is_flat(t);
    if (flat) dropped.add(1, t[0]);
    return flat;
  });
}

void drop_zero_area(const std::vector<Vector3>& points, std::vector<Triangle>& triangles,
                    Counted& dropped) {
  drop_flat(triangles, dropped,
            [&](const Triangle& t) { return collinear(points[t[0]], points[t[1]], points[t[2]]); });
}

/// The diagonal of the box around all triangles.
[[nodiscard]] double extent_of(const PolygonSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : soup.triangles) {
    for (const std::uint32_t corner : triangle) box.extend(soup.points[corner]);
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

/// What was joined along the borders of a mesh.
struct Seams {
  Counted border_edges;  ///< that there were before
  Counted welded;        ///< vertices that became one with another
  Counted split;         ///< triangles that vertices of others on their edges divided
};

/// Each round divides a triangle along one of its edges.
constexpr int most_rounds = 64;

/// Edges that one triangle has alone.
[[nodiscard]] std::vector<HalfEdge> border_edges(const std::vector<Triangle>& triangles) {
  std::vector<HalfEdge> border;
  for_each_edge(sorted_edges(triangles), [&](std::span<const HalfEdge> users) {
    if (users.size() == 1) border.push_back(users[0]);
  });
  return border;
}

[[nodiscard]] std::vector<std::uint32_t> vertices_of(const std::vector<HalfEdge>& border) {
  std::vector<std::uint32_t> vertices;
  for (const HalfEdge& edge : border) vertices.insert(vertices.end(), {edge.low, edge.high});
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

Counted weld(const std::vector<Vector3>& points, double distance,
             const std::vector<HalfEdge>& border, std::vector<Triangle>& triangles) {
  const std::vector<std::uint32_t> vertices = vertices_of(border);
  std::vector<Vector3> places;
  for (const std::uint32_t vertex : vertices) places.push_back(points[vertex]);
  const std::vector<std::uint32_t> joined = join_vertices(places, distance);
  std::map<std::uint32_t, std::uint32_t> first;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    if (joined[i] != i) first[vertices[i]] = vertices[joined[i]];
  }
  if (first.empty()) return {};
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle) {
      if (const auto found = first.find(corner); found != first.end()) corner = found->second;
    }
  }
  return {first.size(), first.begin()->first};
}

/// Vertices by place, to be found near an edge.
class BorderVertices {
 public:
  BorderVertices(const std::vector<Vector3>& points, const std::vector<std::uint32_t>& vertices)
      : points_(points), vertices_(vertices) {
    std::sort(vertices_.begin(), vertices_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double x = points[a].x(), y = points[b].x();
      return x != y ? x < y : a < b;
    });
  }

  /// Those on an edge, ends left out, from its first end on.
  [[nodiscard]] std::vector<std::uint32_t> on(std::uint32_t from, std::uint32_t to,
                                              double distance) const {
    const Vector3 &a = points_[from], &b = points_[to];
    const Vector3 along = b - a;
    const double length = along.norm();
    std::vector<std::pair<double, std::uint32_t>> found;
    const double low = std::min(a.x(), b.x()) - distance, high = std::max(a.x(), b.x()) + distance;
    auto at =
        std::lower_bound(vertices_.begin(), vertices_.end(), low,
                         [&](std::uint32_t vertex, double x) { return points_[vertex].x() < x; });
    for (; at != vertices_.end() && points_[*at].x() <= high; ++at) {
      const Vector3 to_vertex = points_[*at] - a;
      const double way = along.dot(to_vertex) / length;
      if (!(way > distance && way < length - distance)) continue;
      if ((to_vertex - way / length * along).norm() <= distance) found.emplace_back(way, *at);
    }
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> vertices;
    for (const auto& [way, vertex] : found) vertices.push_back(vertex);
    return vertices;
  }

 private:
  const std::vector<Vector3>& points_;
  std::vector<std::uint32_t> vertices_;
};

/// Divides triangles along one border edge each; returns how many, and a vertex that did.
Counted split_once(const std::vector<Vector3>& points, double distance,
                   std::vector<Triangle>& triangles) {
  const std::vector<HalfEdge> border = border_edges(triangles);
  const BorderVertices vertices(points, vertices_of(border));
  std::vector<char> divided(triangles.size(), 0);
  Counted split;
  for (const HalfEdge& edge : border) {
    if (divided[edge.triangle] != 0) continue;
    Triangle triangle = triangles[edge.triangle];
    const std::uint32_t from = edge.forward ? edge.low : edge.high,
                        to = edge.forward ? edge.high : edge.low;
    const std::vector<std::uint32_t> between = vertices.on(from, to, distance);
    while (triangle[0] != from) std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
    const std::uint32_t tip = triangle[2];
    if (between.empty() || std::find(between.begin(), between.end(), tip) != between.end())
      continue;
    divided[edge.triangle] = 1;
    split.add(1, between.front());
    triangles[edge.triangle] = {from, between.front(), tip};
    for (std::size_t i = 0; i < between.size(); ++i) {
      triangles.push_back({between[i], i + 1 < between.size() ? between[i + 1] : to, tip});
    }
  }
  return split;
}

/// Joins what only rounding holds apart along borders: vertices of border edges within `distance`,
/// m, become one, and a border edge is led through the vertices of others that lie on it within
/// that. Nothing else moves.
[[nodiscard]] Seams join_seams(const std::vector<Vector3>& points, double distance,
                               std::vector<Triangle>& triangles) {
  Seams seams;
  const std::vector<HalfEdge> border = border_edges(triangles);
  if (border.empty()) return seams;
  seams.border_edges = {border.size(), border.front().low};
  seams.welded = weld(points, distance, border, triangles);
  if (seams.welded.count > 0) std::erase_if(triangles, repeats_corner);
  for (int round = 0; round < most_rounds; ++round) {
    const Counted split = split_once(points, distance, triangles);
    if (split.count == 0) break;
    seams.split.add(split.count, split.vertex);
  }
  return seams;
}

struct Corners {
  Triangle sorted;
  int sense;  ///< 1 where the triangle runs through them in ascending order, else -1
};

[[nodiscard]] Corners sorted_corners(const Triangle& triangle) {
  Corners corners{triangle, -1};
  std::sort(corners.sorted.begin(), corners.sorted.end());
  const auto at = static_cast<std::size_t>(
      std::find(triangle.begin(), triangle.end(), corners.sorted[0]) - triangle.begin());
  if (triangle[(at + 1) % 3] == corners.sorted[1]) corners.sense = 1;
  return corners;
}

/// Triangles to keep, and those in doubt.
struct Choice {
  std::vector<char> keep;
  std::vector<std::uint32_t> walls;   ///< the first of each pair of triangles that face each other
  std::vector<std::uint32_t> extras;  ///< one that faces the same way for each that is kept
};

[[nodiscard]] Choice choose(const std::vector<Triangle>& triangles) {
  std::vector<Corners> corners;
  corners.reserve(triangles.size());
  for (const Triangle& triangle : triangles) corners.push_back(sorted_corners(triangle));
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(corners[a].sorted, a) < std::tie(corners[b].sorted, b);
  });
  Choice choice;
  choice.keep.assign(triangles.size(), 0);
  for (std::size_t begin = 0; begin < order.size();) {
    int balance = 0;
    std::size_t end = begin;
    for (; end < order.size() && corners[order[end]].sorted == corners[order[begin]].sorted;
         ++end) {
      balance += corners[order[end]].sense;
    }
    if (balance == 0) choice.walls.push_back(order[begin]);
    bool kept = false;
    for (std::size_t i = begin; i < end && balance != 0; ++i) {
      if ((corners[order[i]].sense > 0) != (balance > 0)) continue;
      if (kept) {
        if (std::abs(balance) > 1) choice.extras.push_back(order[i]);
        break;
      }
      choice.keep[order[i]] = 1;
      kept = true;
    }
    begin = end;
  }
  return choice;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

template <class Visit>
void for_each_edge(const Triangle& triangle, Visit visit) {
  for (std::size_t k = 0; k < 3; ++k) visit(Edge(std::minmax(triangle[k], triangle[(k + 1) % 3])));
}

/// How many triangles use each edge of some of them.
using EdgeUses = std::map<Edge, std::uint32_t>;

/// The edges that are open without a group of triangles, less those that it opens. Where nothing
/// but the group and so many copies of it meet, nothing opens.
[[nodiscard]] std::int64_t closed_by(const EdgeUses& group, const EdgeUses& kept,
                                     std::uint32_t copies) {
  std::int64_t closed = 0;
  for (const auto& [edge, uses] : group) {
    const std::uint32_t others = kept.at(edge);
    if (others == copies * uses) continue;
    closed += static_cast<std::int64_t>(others % 2) - (others + uses) % 2;
  }
  return closed;
}

/// Whether a group of triangles ends where nothing else is.
[[nodiscard]] bool ends_freely(const EdgeUses& group, const EdgeUses& kept) {
  return std::any_of(group.begin(), group.end(), [&](const auto& side) {
    return side.second % 2 != 0 && kept.at(side.first) == 0;
  });
}

/// Keeps the connected groups of triangles in doubt without which more edges would be open, and
/// those that end freely. Of each so many copies are kept already.
void keep_closing(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& doubted,
                  std::uint32_t copies, std::vector<char>& keep) {
  EdgeUses kept;
  std::map<Edge, std::vector<std::size_t>> users;
  for (std::size_t i = 0; i < doubted.size(); ++i) {
    for_each_edge(triangles[doubted[i]], [&](const Edge& edge) {
      kept[edge] = 0;
      users[edge].push_back(i);
    });
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (keep[i] == 0) continue;
    for_each_edge(triangles[i], [&](const Edge& edge) {
      if (const auto found = kept.find(edge); found != kept.end()) ++found->second;
    });
  }
  std::vector<char> seen(doubted.size(), 0);
  for (std::size_t seed = 0; seed < seen.size(); ++seed) {
    if (seen[seed] != 0) continue;
    seen[seed] = 1;
    std::vector<std::size_t> group{seed};
    EdgeUses uses;
    for (std::size_t next = 0; next < group.size(); ++next) {
      for_each_edge(triangles[doubted[group[next]]], [&](const Edge& edge) {
        ++uses[edge];
        for (const std::size_t other : users[edge]) {
          if (seen[other] == 0) group.push_back(other);
          seen[other] = 1;
        }
      });
    }
    const char stays = closed_by(uses, kept, copies) > 0 || ends_freely(uses, kept) ? 1 : 0;
    for (const std::size_t member : group) keep[doubted[member]] = stays;
  }
}

/// Drops triangles that have the same corners as another one, and returns how many, with a corner
/// of one. Two triangles that face each other are a wall between two parts, and both go. One of
/// them stays where the surface would be open without it, where they end freely, as a leaf that is
/// drawn from both sides does, and where most of the mesh is drawn so. Of triangles that face the
/// same way one stays, except where two parts share a face and dropping it would open one of them.
[[nodiscard]] Counted drop_duplicates(std::vector<Triangle>& triangles) {
  Choice choice = choose(triangles);
  const bool two_sided = 4 * choice.walls.size() > triangles.size();
  if (two_sided) {
    for (const std::uint32_t wall : choice.walls) choice.keep[wall] = 1;
  } else {
    keep_closing(triangles, choice.walls, 0, choice.keep);
  }
  keep_closing(triangles, choice.extras, 1, choice.keep);
  Counted dropped;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (choice.keep[i] != 0) {
      triangles[kept++] = triangles[i];
    } else {
      dropped.add(1, triangles[i][0]);
    }
  }
  triangles.resize(kept);
  return dropped;
}

/// The parts that are looked at: crowded at some edge, and made of patches that are not all closed.
[[nodiscard]] std::vector<char> divided_parts(std::span<const Vector3> points,
                                              const std::vector<Triangle>& triangles,
                                              const std::vector<HalfEdge>& edges, Groups& parts) {
  Groups patches(triangles.size());
  for_each_edge(edges, [&](std::span<const HalfEdge> users) {
    if (users.size() == 2) patches.join(users[0].triangle, users[1].triangle);
  });
  std::vector<char> crowded(triangles.size(), 0), open(triangles.size(), 0);
  for_each_edge(edges, [&](std::span<const HalfEdge> users) {
    const std::uint32_t part = parts.of(users[0].triangle);
    if (users.size() > 2) crowded[part] = 1;
    std::map<std::uint32_t, std::size_t> uses;
    for (const HalfEdge& user : users) ++uses[patches.of(user.triangle)];
    for (const auto& [patch, count] : uses) {
      if (count % 2 != 0) open[part] = 1;
    }
  });
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    const std::uint32_t part = parts.of(t);
    if (crowded[part] != 0 && collinear(points[a], points[b], points[c])) open[part] = 0;
  }
  for (std::size_t part = 0; part < open.size(); ++part) {
    if (crowded[part] == 0) open[part] = 0;
  }
  return open;
}

/// Joins the sides of triangles that face each other around edges. Parts in which that is not clear
/// are no longer looked at.
[[nodiscard]] Groups cells_of(std::span<const Vector3> points,
                              const std::vector<Triangle>& triangles,
                              const std::vector<HalfEdge>& edges, Groups& parts,
                              std::vector<char>& divided) {
  Groups cells(2 * triangles.size());
  for_each_edge(edges, [&](std::span<const HalfEdge> users) {
    char& wanted = divided[parts.of(users[0].triangle)];
    if (wanted == 0) return;
    const std::vector<FanLeaf> fan = triangle_fan(
        triangles, users, [&](std::uint32_t vertex) { return exact_point(points[vertex]); });
    if (std::any_of(fan.begin(), fan.end(), [](const FanLeaf& leaf) { return leaf.on_last; })) {
      wanted = 0;
      return;
    }
    for (std::size_t i = 0; i < fan.size(); ++i) {
      cells.join(ahead(fan[i].user), behind(fan[(i + 1) % fan.size()].user));
    }
  });
  return cells;
}

/// Turns outward what bounds a part from outside, and drops what only lies between its cells, as
/// between the tetrahedra of a volume mesh; returns how many triangles were dropped, with a corner
/// of one. Only of parts that more than two triangles at an edge divide into cells, and that are no
/// closed surfaces which touch. Which way their triangles face in the file does not matter. Parts
/// whose triangles lie on one another, or have no area, stay as they are.
[[nodiscard]] Counted drop_inner_faces(std::span<const Vector3> points,
                                       std::vector<Triangle>& triangles) {
  const std::vector<HalfEdge> edges = sorted_edges(triangles);
  bool is_crowded = false;
  for_each_edge(
      edges, [&](std::span<const HalfEdge> users) { is_crowded = is_crowded || users.size() > 2; });
  if (!is_crowded) return {};
  Groups parts = parts_over(edges, triangles.size());
  std::vector<char> divided = divided_parts(points, triangles, edges, parts);
  if (std::count(divided.begin(), divided.end(), 1) == 0) return {};
  Groups cells = cells_of(points, triangles, edges, parts, divided);

  // The outside of a part is what has its volume with the other sign.
  std::vector<double> volumes(2 * triangles.size(), 0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t part = parts.of(t);
    if (divided[part] == 0) continue;
    const Vector3& origin = points[triangles[part][0]];
    const auto& [a, b, c] = triangles[t];
    const double volume = (points[a] - origin).dot((points[b] - origin).cross(points[c] - origin));
    volumes[cells.of(back(t))] += volume;
    volumes[cells.of(front(t))] -= volume;
  }
  std::map<std::uint32_t, std::uint32_t> outside;  // the cell around each part
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (divided[parts.of(t)] == 0) continue;
    for (const std::uint32_t side : {front(t), back(t)}) {
      const std::uint32_t cell = cells.of(side);
      const auto [found, fresh] = outside.try_emplace(parts.of(t), cell);
      if (!fresh && volumes[cell] < volumes[found->second]) found->second = cell;
    }
  }
  Counted dropped;
  std::size_t kept = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    Triangle triangle = triangles[t];
    if (divided[parts.of(t)] != 0) {
      const std::uint32_t around = outside.at(parts.of(t));
      const bool reached_in_front = cells.of(front(t)) == around,
                 reached_behind = cells.of(back(t)) == around;
      if (!reached_in_front && !reached_behind) {
        dropped.add(1, triangle[0]);
        continue;
      }
      if (!reached_in_front) std::swap(triangle[1], triangle[2]);
    }
    triangles[kept++] = triangle;
  }
  triangles.resize(kept);
  return dropped;
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
  return CGAL::collinear(plain_point(a), plain_point(b), plain_point(c));
}

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

void repair(PolygonSoup soup, Mesh& mesh) {
  mesh.file_vertices = soup.points.size();
  mesh.file_triangles = soup.triangles.size();
  Changes changes;
  changes.merged = merge_equal_points(soup);
  drop_flat(soup.triangles, changes.dropped, repeats_corner);
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
  mesh.vertices = std::move(soup.points);
  compact(mesh.vertices, mesh.triangles);
  mesh.vertices.shrink_to_fit();  // of an STL most points were copies
}

}  // namespace spm::baker
