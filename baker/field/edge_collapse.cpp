// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/edge_collapse.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::baker {

namespace {

/// Other sheets are farther than so many displacements from where the surface may move.
constexpr double clear_displacements = 4;
/// All that is nearer faces within this of the surface there.
constexpr double one_way_cosine = 0.2;
/// Of doubles, m, and of heights over a plane.
constexpr double rounding = 1e-12;
/// Vertices are drawn that move the surface by no more than one of these shares of what they may,
/// and so often of each, before the next one.
constexpr std::array<double, 4> shares{0.125, 0.25, 0.5, 1};
constexpr int times = 3;
/// The edges of the cubes in which vertices are drawn, of the diagonal, but at least so many mean
/// sides of triangles; and where these begin, in edges: what lies across the sides of the first
/// ones lies within the second ones.
constexpr double cube_share = 1.0 / 24;
constexpr double cube_sides = 32;
constexpr std::array<double, 2> offsets{0, 0.5};
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The triangles around a vertex, which are a disk, over a plane along the mean of their normals.
class VertexPatch {
 public:
  static constexpr std::size_t most = 16;  ///< triangles

  /// Empty where they are no disk of the surface, too many, or fold over the plane. `star` holds
  /// the numbers of the triangles that have the vertex.
  static std::optional<VertexPatch> around(std::uint32_t vertex,
                                           const std::vector<Vector3>& vertices,
                                           const std::vector<LooseTriangle>& triangles,
                                           std::span<const std::uint32_t> star);

  [[nodiscard]] std::size_t size() const { return count_; }
  /// The neighbours in order around the vertex.
  [[nodiscard]] std::span<const std::uint32_t> ring() const { return {ring_.data(), count_}; }
  [[nodiscard]] const Vector3& normal() const { return normal_; }  ///< unit, of the plane

  struct Shape {
    double least_height = 0;  ///< m, of a new triangle
    double least_cosine = 0;  ///< of the angle from a new triangle's normal to the plane's
  };
  /// The fan from the k-th neighbour that may replace the triangles; empty where it folds over the
  /// plane.
  [[nodiscard]] std::optional<Shape> shape_of_fan(std::size_t k) const;
  /// How far that fan, which must not fold, is from the triangles at most, along the normal, m.
  [[nodiscard]] double gap_of_fan(std::size_t k) const;

 private:
  std::size_t count_ = 0;
  std::array<std::uint32_t, most> ring_{};
  std::array<Vector3, most> places_{};  ///< of the ring in the plane and above it, from the vertex
  Vector3 normal_ = Vector3::Zero();

  [[nodiscard]] const Vector3& place(std::size_t k) const {
    return places_[k < count_ ? k : k - count_];
  }
  [[nodiscard]] double gap_at_vertex(std::size_t k) const;
  [[nodiscard]] double gap_along(std::size_t k, std::size_t to) const;
};

/// Twice the area of a triangle with a corner at the origin, seen from above the plane.
double cross(const Vector3& a, const Vector3& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The two other corners of a triangle, in order.
std::array<std::uint32_t, 2> others(const Triangle& triangle, std::uint32_t vertex) {
  if (triangle[0] == vertex) return {triangle[1], triangle[2]};
  if (triangle[1] == vertex) return {triangle[2], triangle[0]};
  return {triangle[0], triangle[1]};
}

std::optional<VertexPatch> VertexPatch::around(std::uint32_t vertex,
                                               const std::vector<Vector3>& vertices,
                                               const std::vector<LooseTriangle>& triangles,
                                               std::span<const std::uint32_t> star) {
  if (star.size() < 3 || star.size() > most) return std::nullopt;
  VertexPatch patch;
  patch.count_ = star.size();
  const Vector3& middle = vertices[vertex];
  std::array<std::array<std::uint32_t, 2>, most> sides{};
  Vector3 normal = Vector3::Zero();
  for (std::size_t i = 0; i < star.size(); ++i) {
    if (triangles[star[i]].sheet) return std::nullopt;
    sides[i] = others(triangles[star[i]].corners, vertex);
    normal += (vertices[sides[i][0]] - middle).cross(vertices[sides[i][1]] - middle);
  }
  if (!(normal.norm() > 0)) return std::nullopt;
  patch.normal_ = normal.normalized();
  // Each side leads on from the one before, and the last one back to the first.
  for (std::size_t i = 0; i < star.size(); ++i) {
    patch.ring_[i] = sides[i][0];
    const std::size_t next = i + 1;
    if (next == star.size()) {
      if (sides[i][1] != patch.ring_[0]) return std::nullopt;
      break;
    }
    std::size_t found = next;
    while (found < star.size() && sides[found][0] != sides[i][1]) ++found;
    if (found == star.size()) return std::nullopt;
    std::swap(sides[next], sides[found]);
  }
  const Vector3 first = patch.normal_.unitOrthogonal(), second = patch.normal_.cross(first);
  for (std::size_t i = 0; i < patch.count_; ++i) {
    const Vector3 away = vertices[patch.ring_[i]] - middle;
    patch.places_[i] = {away.dot(first), away.dot(second), away.dot(patch.normal_)};
  }
  // Once around, and nowhere back.
  int turns = 0;
  for (std::size_t i = 0; i < patch.count_; ++i) {
    const Vector3 &a = patch.place(i), &b = patch.place(i + 1);
    if (!(cross(a, b) > 0)) return std::nullopt;
    turns += a.y() < 0 && b.y() >= 0 ? 1 : 0;
  }
  return turns == 1 ? std::optional(patch) : std::nullopt;
}

std::optional<VertexPatch::Shape> VertexPatch::shape_of_fan(std::size_t k) const {
  Shape shape{std::numeric_limits<double>::infinity(), 1};
  for (std::size_t i = 1; i + 1 < count_; ++i) {
    const Vector3 a = place(k + i) - place(k), b = place(k + i + 1) - place(k);
    const Vector3 twice = a.cross(b);
    const double area = twice.norm();
    if (!(twice.z() > 0)) return std::nullopt;
    const double longest =
        std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()}));
    shape.least_height = std::min(shape.least_height, area / longest);
    shape.least_cosine = std::min(shape.least_cosine, twice.z() / area);
  }
  return shape;
}

double VertexPatch::gap_of_fan(std::size_t k) const {
  // Both are flat between the places where a line of one crosses a line of the other, and between
  // these and the vertex.
  double gap = gap_at_vertex(k);
  for (std::size_t i = 2; i + 1 < count_; ++i) gap = std::max(gap, gap_along(k, i));
  return gap;
}

/// How high the fan is over the vertex, m.
double VertexPatch::gap_at_vertex(std::size_t k) const {
  const Vector3& from = place(k);
  // The triangle below it: the vertex is on the left of one of its sides and on the right of the
  // next.
  std::size_t i = 1;
  while (i + 2 < count_ && cross(place(k + i + 1) - from, -from) >= 0) ++i;
  const Vector3 normal = (place(k + i) - from).cross(place(k + i + 1) - from);
  return std::abs(normal.dot(from) / normal.z());
}

/// How far the fan is from the triangles along its side from the k-th neighbour to the one that is
/// `to` places further, m.
double VertexPatch::gap_along(std::size_t k, std::size_t to) const {
  const Vector3& from = place(k);
  const Vector3 along = place(k + to) - from;
  const double length = along.x() * along.x() + along.y() * along.y();
  const double at_vertex = cross(along, -from);
  double gap = 0;
  for (std::size_t m = 1; m < count_; ++m) {
    if (m == to) continue;
    const Vector3& end = place(k + m);
    const double at_end = cross(along, end - from);
    if (at_vertex * at_end >= 0) continue;  // the two are on one side of the line
    const Vector3 there = at_vertex / (at_vertex - at_end) * end;
    const double share =
        (along.x() * (there.x() - from.x()) + along.y() * (there.y() - from.y())) / length;
    gap = std::max(gap, std::abs(there.z() - from.z() - share * along.z()));
  }
  return gap;
}

class EdgeCollapse {
 public:
  EdgeCollapse(const std::vector<Vector3>& vertices, const Caster& caster,
               const CollapseRules& rules, std::vector<LooseTriangle>& triangles)
      : vertices_(vertices),
        caster_(caster),
        rules_(rules),
        triangles_(triangles),
        moved_(triangles.size(), 0),
        stars_(vertices.size()),
        states_(vertices.size(), State::asked),
        choices_(vertices.size()),
        cubes_(vertices.size(), 0) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (const std::uint32_t corner : triangles[t].corners) stars_[corner].push_back(t);
    }
    tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t vertex) {
      if (!is_clear(static_cast<std::uint32_t>(vertex))) states_[vertex] = State::fixed;
    });
  }

  void run() {
    for (const double offset : offsets) {
      const CubeBins cubes = cubes_from(offset);
      tbb::parallel_for(std::size_t{0}, cube_count_, [&](std::size_t i) {
        const std::span<const std::uint32_t> own = cubes.of(i, i);
        for (const double share : shares) {
          for (int time = 0; time < times; ++time) {
            if (draw_some(own, share * rules_.displacement) == 0) break;
          }
        }
      });
    }
  }

  /// Takes the triangles away that are none any more, and gives how far each other one has moved.
  std::vector<double> finish() {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (triangles_[t].corners[0] == triangles_[t].corners[1]) continue;
      triangles_[kept] = triangles_[t];
      moved_[kept++] = moved_[t];
    }
    triangles_.resize(kept);
    moved_.resize(kept);
    return std::move(moved_);
  }

 private:
  enum class State : std::uint8_t {
    fixed,   ///< it stays, or is gone
    asked,   ///< its choice is to be found
    chosen,  ///< it may be drawn to its choice
    stuck,   ///< it may be drawn to no neighbour, as these are
  };
  struct Choice {
    double moved = 0;  ///< m, in all
    std::uint32_t to = none;
  };

  const std::vector<Vector3>& vertices_;
  const Caster& caster_;
  CollapseRules rules_;
  std::vector<LooseTriangle>& triangles_;
  std::vector<double> moved_;  ///< m, by triangle
  std::vector<std::vector<std::uint32_t>> stars_;
  std::vector<State> states_;
  std::vector<Choice> choices_;
  std::vector<std::uint32_t> cubes_;  ///< in which each vertex lies
  std::size_t cube_count_ = 0;

  [[nodiscard]] std::optional<VertexPatch> patch_of(std::uint32_t vertex) const {
    return VertexPatch::around(vertex, vertices_, triangles_, stars_[vertex]);
  }

  /// Whether all of the surface near the triangles of a vertex faces as they do.
  [[nodiscard]] bool is_clear(std::uint32_t vertex) const {
    const auto patch = patch_of(vertex);
    if (!patch) return false;
    double reach = 0;
    for (const std::uint32_t other : patch->ring()) {
      reach = std::max(reach, (vertices_[other] - vertices_[vertex]).norm());
    }
    reach += clear_displacements * rules_.displacement;
    thread_local std::vector<std::uint32_t> near;
    caster_.boxes_within(vertices_[vertex], reach, near);
    return std::none_of(near.begin(), near.end(), [&](std::uint32_t t) {
      if (!caster_.is_sheet(t) && caster_.normal(t).dot(patch->normal()) > one_way_cosine) {
        return false;
      }
      const Vector3 closest = closest_on_triangle(vertices_[vertex], caster_.corner(t, 0),
                                                  caster_.corner(t, 1), caster_.corner(t, 2));
      return (closest - vertices_[vertex]).norm() <= reach;
    });
  }

  /// The neighbour to which a vertex is drawn so that the surface moves least.
  [[nodiscard]] Choice choose(std::uint32_t vertex, const VertexPatch& patch) const {
    double before = 0;
    for (const std::uint32_t t : stars_[vertex]) before = std::max(before, moved_[t]);
    Choice best;
    double least = rules_.displacement;
    if (before >= least) return best;
    for (std::size_t k = 0; k < patch.size(); ++k) {
      const auto shape = patch.shape_of_fan(k);
      if (!shape || shape->least_height < rules_.height ||
          shape->least_cosine < rules_.min_cosine) {
        continue;
      }
      const double moved = before + patch.gap_of_fan(k) + rounding;
      if (moved >= least || !stays_simple(patch, k)) continue;
      least = moved;
      best = {moved, patch.ring()[k]};
    }
    return best;
  }

  /// Whether the fan from the k-th neighbour has no side that is there already: of the others
  /// around only the two beside it are its neighbours.
  [[nodiscard]] bool stays_simple(const VertexPatch& patch, std::size_t k) const {
    const auto ring = patch.ring();
    for (const std::uint32_t t : stars_[ring[k]]) {
      for (const std::uint32_t corner : triangles_[t].corners) {
        const auto at =
            static_cast<std::size_t>(std::find(ring.begin(), ring.end(), corner) - ring.begin());
        if (at == ring.size() || at == k) continue;
        const std::size_t further = (at + ring.size() - k) % ring.size();
        if (further != 1 && further + 1 != ring.size()) return false;
      }
    }
    return true;
  }

  /// m, of the first sides of all triangles.
  [[nodiscard]] double mean_side() const {
    double sum = 0;
    for (const LooseTriangle& triangle : triangles_) {
      sum += (vertices_[triangle.corners[1]] - vertices_[triangle.corners[0]]).norm();
    }
    return sum / std::max<double>(1, static_cast<double>(triangles_.size()));
  }

  /// The vertices that are not fixed, by the cube in which they lie.
  CubeBins cubes_from(double offset) {
    const double edge = std::max(cube_share * caster_.diagonal(), cube_sides * mean_side());
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vector3& vertex : vertices_) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
    low -= Vector3::Constant(offset * edge);
    const CubeGrid grid(low, high - low, edge);
    std::vector<CubeBins::Member> members;
    for (std::uint32_t vertex = 0; vertex < vertices_.size(); ++vertex) {
      const auto [x, y, z] = grid.nearest(vertices_[vertex]);
      cubes_[vertex] = static_cast<std::uint32_t>(grid.number(x, y, z));
      if (states_[vertex] == State::fixed) continue;
      // Those that had neighbours in other cubes may have none now.
      states_[vertex] = State::asked;
      members.emplace_back(cubes_[vertex], vertex);
    }
    cube_count_ = grid.cubes();
    return {cube_count_, members};
  }

  /// Draws those of some vertices, all of one cube, to their choices that then have moved by no
  /// more than `most`, m; gives how many. Nothing outside the cube is changed, so that others may
  /// be drawn at the same time in others.
  std::size_t draw_some(std::span<const std::uint32_t> own, double most) {
    std::size_t drawn = 0;
    for (const std::uint32_t vertex : own) {
      if (states_[vertex] == State::fixed || states_[vertex] == State::stuck) continue;
      if (states_[vertex] == State::chosen && choices_[vertex].moved > most) continue;
      const auto patch = patch_of(vertex);
      const bool within = patch && std::all_of(patch->ring().begin(), patch->ring().end(),
                                               [&](auto v) { return cubes_[v] == cubes_[vertex]; });
      if (within) choices_[vertex] = choose(vertex, *patch);
      const bool any = within && choices_[vertex].to != none;
      states_[vertex] = any ? State::chosen : State::stuck;
      if (!any || choices_[vertex].moved > most) continue;
      draw(vertex, *patch);
      ++drawn;
    }
    return drawn;
  }

  /// Draws a vertex to its choice.
  void draw(std::uint32_t vertex, const VertexPatch& patch) {
    const std::uint32_t to = choices_[vertex].to;
    states_[vertex] = State::fixed;
    for (const std::uint32_t other : patch.ring()) {
      if (states_[other] != State::fixed) states_[other] = State::asked;
    }
    for (const std::uint32_t t : stars_[vertex]) {
      LooseTriangle& triangle = triangles_[t];
      auto& corners = triangle.corners;
      if (std::find(corners.begin(), corners.end(), to) != corners.end()) {
        for (const std::uint32_t corner : corners) {
          if (corner != vertex) std::erase(stars_[corner], t);
        }
        corners = {};
        continue;
      }
      std::replace(corners.begin(), corners.end(), vertex, to);
      moved_[t] = choices_[vertex].moved;
      stars_[to].push_back(t);
    }
    stars_[vertex].clear();
  }
};

}  // namespace

std::vector<double> collapse_edges(const std::vector<Vector3>& vertices, const Caster& caster,
                                   const CollapseRules& rules,
                                   std::vector<LooseTriangle>& triangles) {
  EdgeCollapse collapse(vertices, caster, rules, triangles);
  collapse.run();
  return collapse.finish();
}

}  // namespace spm::baker
