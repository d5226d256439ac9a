// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/edge_collapse.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "baker/base/cube_bins.hpp"
#include "baker/field/vertex_patch.hpp"
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
