// SPDX-License-Identifier: Apache-2.0
#include "common/contour/contour_mesh.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "common/contour/surface_box.hpp"
#include "common/query/query.hpp"

namespace spm {

namespace {

constexpr int block = 8;          // cells along a block's edge, which is skipped as a whole
constexpr int halvings = 12;      // of a part of a grid's edge, to find its crossing
constexpr int steps = 64;         // along an edge at most, to find a wall between its ends
constexpr double pull = 0.02;     // to the mean of the crossings, where their planes say nothing
constexpr double beside = 1.37;   // cells beside the box: its sides lie in no plane of the grid
constexpr double opposed = -0.5;  // cosine of normals, below which they are of two sheets
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

using Cell = std::array<int, 3>;

/// What was left out by the bake lies in closed hollows.
bool is_inside(const Answer& answer) noexcept {
  if (answer.status == Status::far) return false;
  return answer.status != Status::exact || answer.distance < 0;
}

/// Where the surface crosses an edge of the grid.
struct Crossing {
  Cell edge{};  ///< its lower corner
  int axis = 0;
  bool enters = false;      ///< the solid, upwards along the axis
  bool one_of_two = false;  ///< of a wall or a gap between the edge's ends; the other is beside it
  Vector3 place = Vector3::Zero(), normal = Vector3::Zero();
};

/// Sums over the crossings of one vertex: the quadratic error of the distances to their planes.
struct Planes {
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  Vector3 right = Vector3::Zero(), sum = Vector3::Zero();
  int count = 0;

  void add(const Crossing& crossing) noexcept {
    square += crossing.normal * crossing.normal.transpose();
    right += crossing.normal.dot(crossing.place) * crossing.normal;
    sum += crossing.place;
    ++count;
  }
  [[nodiscard]] Vector3 best() const noexcept {
    const Vector3 mean = sum / count;
    const Eigen::Matrix3d held = square + pull * Eigen::Matrix3d::Identity();
    return held.ldlt().solve(right + pull * mean);
  }
};

/// A side of a triangle between the vertices of two neighbouring cells.
struct Side {
  std::uint64_t cells = 0;         ///< both, the smaller number above the larger one
  std::uint32_t from = 0, to = 0;  ///< vertices, of the smaller and of the larger number
  int sense = 0;                   ///< 1: so run through, -1: the other way
};

/// Two sheets in one cell.
struct Sheets {
  std::array<std::uint32_t, 2> vertices{};
  Vector3 across = Vector3::Zero();  ///< unit, outward on the first
  Vector3 beyond = Vector3::Zero();  ///< over their rim, where they end in this cell
};

class Contour {
 public:
  Contour(const AssetView& asset, int cells) : asset_(asset) {
    const Extent box = surface_box(asset);
    cell_ = box.size.maxCoeff() / cells;
    for (int axis = 0; axis < 3; ++axis) {
      // A cell more on each side, so that the surface never meets the end of the grid.
      counts_[axis] = static_cast<int>(std::ceil(box.size[axis] / cell_)) + 3;
    }
    origin_ = box.low - Vector3::Constant(beside * cell_);
    reach_.resize(corners(), static_cast<float>(cell_));
    cells_.resize(corners(), none);
  }

  ContourMesh make() {
    for (int z = 0; z <= counts_[2]; z += block) {
      for (int y = 0; y <= counts_[1]; y += block) {
        for (int x = 0; x <= counts_[0]; x += block) look_at({x, y, z});
      }
    }
    for (int axis = 0; axis < 3; ++axis) cross_edges(axis);
    make_vertices();
    span_quads();
    close_rims();
    for (const auto& [cell, sheets] : split_) {
      reach_for_rim(cell, sheets);
    }
    for (std::uint32_t i = 0; i < mesh_.vertices.size(); ++i) settle(i);
    mesh_.cell = cell_;
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::size_t corners() const noexcept {
    return std::size_t(counts_[0] + 1) * std::size_t(counts_[1] + 1) * std::size_t(counts_[2] + 1);
  }
  [[nodiscard]] std::size_t at(const Cell& corner) const noexcept {
    return (std::size_t(corner[2]) * std::size_t(counts_[1] + 1) + std::size_t(corner[1])) *
               std::size_t(counts_[0] + 1) +
           std::size_t(corner[0]);
  }
  [[nodiscard]] Vector3 place(const Cell& corner) const noexcept {
    return origin_ + cell_ * Vector3(corner[0], corner[1], corner[2]);
  }

  /// How far the surface is from a place at least, below 0 inside.
  [[nodiscard]] double reach(const Answer& answer, const Vector3& point) const noexcept {
    switch (answer.status) {
      case Status::far:
        return asset_.full ? asset_.band.margin
                           : std::max(asset_.band.margin, clearance(asset_, point));
      case Status::pruned:
        return -cell_;  // there is nothing to see
      default:
        return answer.distance;
    }
  }

  /// Finds the sides of the corners of a block, which mostly is far from the surface.
  void look_at(const Cell& first) {
    const Vector3 middle = place(first) + Vector3::Constant(cell_ * (block - 1) / 2.0);
    const double half = cell_ * block * std::sqrt(3.0) / 2;
    if (!asset_.full && clearance(asset_, middle) > half + cell_) return;
    Cell last;
    for (int axis = 0; axis < 3; ++axis) {
      last[axis] = std::min(first[axis] + block - 1, counts_[axis]);
    }
    for (int z = first[2]; z <= last[2]; ++z) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int x = first[0]; x <= last[0]; ++x) {
          const Vector3 point = place({x, y, z});
          const Answer answer = query_point(asset_, point);
          const double far = std::abs(reach(answer, point));
          reach_[at({x, y, z})] = static_cast<float>(is_inside(answer) ? -far : far);
        }
      }
    }
  }

  /// Finds where the surface crosses the edges along an axis.
  void cross_edges(int axis) {
    for (int z = 1; z < counts_[2]; ++z) {
      for (int y = 1; y < counts_[1]; ++y) {
        for (int x = 1; x < counts_[0]; ++x) {
          const Cell from{x, y, z};
          Cell to = from;
          ++to[axis];
          const double low = reach_[at(from)], high = reach_[at(to)];
          if (std::signbit(low) != std::signbit(high)) {
            cross({from, axis, !std::signbit(low)}, place(from), place(to));
          } else if (std::abs(low) + std::abs(high) < cell_) {
            cross_wall(from, axis, low, high);
          }
        }
      }
    }
  }

  /// Between ends on one side there may be a wall, or a gap, that is thinner than a cell.
  void cross_wall(const Cell& from, int axis, double low, double high) {
    const Vector3 begin = place(from);
    const bool inside = std::signbit(low);
    Vector3 before = begin, end = begin;
    end[axis] += cell_;
    for (double way = std::abs(low); way < cell_ - std::abs(high);) {
      Vector3 point = begin;
      point[axis] += way;
      const Answer answer = query_point(asset_, point);
      if (is_inside(answer) != inside) {
        cross({from, axis, !inside, true}, before, point);
        cross({from, axis, inside, true}, point, end);
        return;
      }
      before = point;
      way += std::max(std::abs(reach(answer, point)), cell_ / steps);
    }
  }

  /// Adds a crossing between two places of its edge that lie on different sides.
  void cross(Crossing crossing, const Vector3& low, const Vector3& high) {
    Vector3 in = crossing.enters ? high : low, out = crossing.enters ? low : high;
    for (int i = 0; i < halvings; ++i) {
      const Vector3 middle = (in + out) / 2;
      (is_inside(query_point(asset_, middle)) ? in : out) = middle;
    }
    crossing.place = in;
    crossing.normal = query_point(asset_, in).normal;
    crossings_.push_back(crossing);
  }

  /// The four cells about an edge, in order.
  [[nodiscard]] static std::array<Cell, 4> cells_about(const Crossing& crossing) noexcept {
    const int left = (crossing.axis + 1) % 3, up = (crossing.axis + 2) % 3;
    std::array<Cell, 4> about{crossing.edge, crossing.edge, crossing.edge, crossing.edge};
    --about[1][left];
    --about[2][left];
    --about[2][up];
    --about[3][up];
    return about;
  }

  std::uint32_t number_of(const Cell& cell) {
    std::uint32_t& number = cells_[at(cell)];
    if (number == none) {
      number = static_cast<std::uint32_t>(owners_.size());
      owners_.push_back(cell);
    }
    return number;
  }

  /// A vertex for each cell, or two where two sheets lie in it.
  void make_vertices() {
    // Corners of the quadrangles by their cells: which crossing, and which of its four.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> uses;
    uses.reserve(4 * crossings_.size());
    for (std::uint32_t i = 0; i < crossings_.size(); ++i) {
      const std::array<Cell, 4> about = cells_about(crossings_[i]);
      for (std::uint32_t k = 0; k < 4; ++k) uses.emplace_back(number_of(about[k]), 4 * i + k);
    }
    std::sort(uses.begin(), uses.end());
    quads_.resize(uses.size());
    for (std::size_t first = 0; first < uses.size();) {
      std::size_t last = first;
      while (last < uses.size() && uses[last].first == uses[first].first) ++last;
      make_vertices_of(uses[first].first, {uses.data() + first, last - first});
      first = last;
    }
  }

  void make_vertices_of(std::uint32_t cell,
                        std::span<const std::pair<std::uint32_t, std::uint32_t>> uses) {
    const auto normal = [&](std::size_t use) -> const Vector3& {
      return crossings_[uses[use].second / 4].normal;
    };
    double least = opposed;
    Vector3 across = Vector3::Zero();
    for (std::size_t i = 0; i < uses.size(); ++i) {
      for (std::size_t k = i + 1; k < uses.size(); ++k) {
        if (normal(i).dot(normal(k)) >= least) continue;
        least = normal(i).dot(normal(k));
        across = normal(i) - normal(k);
      }
    }
    std::array<Planes, 2> sheets;
    for (std::size_t i = 0; i < uses.size(); ++i) {
      sheets[across.dot(normal(i)) < 0 ? 1 : 0].add(crossings_[uses[i].second / 4]);
    }
    std::array<std::uint32_t, 2> vertices{};
    for (std::size_t sheet = 0; sheet < 2; ++sheet) {
      if (sheets[sheet].count > 0) vertices[sheet] = place_vertex(cell, sheets[sheet].best());
    }
    for (std::size_t i = 0; i < uses.size(); ++i) {
      quads_[uses[i].second] = vertices[across.dot(normal(i)) < 0 ? 1 : 0];
    }
    if (least < opposed) {
      split_[cell] = {vertices, across.normalized(), Vector3::Zero()};
    }
  }

  /// The best place may lie far from a cell that is almost flat.
  std::uint32_t place_vertex(std::uint32_t cell, const Vector3& best) {
    mesh_.vertices.emplace_back();
    const auto vertex = static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
    move_vertex(vertex, cell, best);
    return vertex;
  }

  [[nodiscard]] Vector3 at_vertex(std::uint32_t vertex) const noexcept {
    const auto& at = mesh_.vertices[vertex];
    return {at[0], at[1], at[2]};
  }

  void set_vertex(std::uint32_t vertex, const Vector3& to) {
    mesh_.vertices[vertex] = {static_cast<float>(to[0]), static_cast<float>(to[1]),
                              static_cast<float>(to[2])};
  }

  /// As far as its cell reaches.
  void move_vertex(std::uint32_t vertex, std::uint32_t cell, const Vector3& to) {
    const Vector3 low = place(owners_[cell]);
    set_vertex(vertex, to.cwiseMax(low).cwiseMin(low + Vector3::Constant(cell_)));
  }

  /// Moves the ends of two sheets to where the wall between them ends: no crossing tells of it.
  void reach_for_rim(std::uint32_t cell, const Sheets& sheets) {
    const Vector3 way = sheets.beyond - sheets.across.dot(sheets.beyond) * sheets.across;
    if (way.norm() < cell_ / steps) return;
    const std::array<Vector3, 2> ends{at_vertex(sheets.vertices[0]), at_vertex(sheets.vertices[1])};
    const Vector3 start = (ends[0] + ends[1]) / 2;
    const bool wall = is_inside(query_point(asset_, start));
    Vector3 in = start;
    Vector3 out = in + cell_ * way.normalized();
    if (is_inside(query_point(asset_, out)) == wall) return;
    for (int i = 0; i < halvings; ++i) {
      const Vector3 middle = (in + out) / 2;
      (is_inside(query_point(asset_, middle)) == wall ? in : out) = middle;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      move_vertex(sheets.vertices[i], cell, ends[i] + in - start);
    }
  }

  /// Moves a vertex onto the surface, which bends within its cell.
  void settle(std::uint32_t vertex) {
    const Vector3 at = at_vertex(vertex);
    const Answer answer = query_point(asset_, at);
    if (answer.status != Status::exact || !(std::abs(answer.distance) < cell_)) return;
    set_vertex(vertex, at - answer.distance * answer.normal);
  }

  /// A quadrangle between the four cells about each crossing.
  void span_quads() {
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      // A ridge that an edge just grazes: both quadrangles are one, seen from its two sides.
      if (crossings_[i].one_of_two && i + 1 < crossings_.size() && is_same_edge(i) &&
          std::equal(&quads_[4 * i], &quads_[4 * i] + 4, &quads_[4 * i] + 4)) {
        ++i;
        continue;
      }
      std::array<Cell, 4> about = cells_about(crossings_[i]);
      std::array<std::uint32_t, 4> quad{};
      std::copy_n(&quads_[4 * i], 4, quad.begin());
      if (crossings_[i].enters) {
        std::swap(quad[1], quad[3]);
        std::swap(about[1], about[3]);
      }
      add_triangle(quad[0], quad[1], quad[2]);
      add_triangle(quad[0], quad[2], quad[3]);
      for (std::size_t k = 0; k < 4; ++k) {
        add_side(about[k], about[(k + 1) % 4], quad[k], quad[(k + 1) % 4]);
      }
    }
  }

  [[nodiscard]] bool is_same_edge(std::size_t i) const noexcept {
    const Crossing &one = crossings_[i], &other = crossings_[i + 1];
    return other.one_of_two && one.edge == other.edge && one.axis == other.axis;
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.triangles.insert(mesh_.triangles.end(), {a, b, c});
  }

  /// Keeps a side that may have no other one against it: those of cells with two vertices.
  void add_side(const Cell& cell, const Cell& next, std::uint32_t from, std::uint32_t to) {
    const std::uint32_t a = cells_[at(cell)], b = cells_[at(next)];
    if (!split_.contains(a) && !split_.contains(b)) return;
    if (a < b) {
      sides_.push_back({std::uint64_t{a} << 32U | b, from, to, 1});
    } else {
      sides_.push_back({std::uint64_t{b} << 32U | a, to, from, -1});
    }
  }

  /// Where two sheets end in cells side by side, as at the rim of a bowl, closes what is between.
  void close_rims() {
    std::sort(sides_.begin(), sides_.end(), [](const Side& one, const Side& other) {
      return std::tie(one.cells, one.from, one.to) < std::tie(other.cells, other.from, other.to);
    });
    std::vector<Side> ahead, back;
    for (std::size_t first = 0; first < sides_.size();) {
      ahead.clear();
      back.clear();
      std::size_t next = first;
      while (next < sides_.size() && sides_[next].cells == sides_[first].cells) {
        const Side& side = sides_[next];
        int sum = 0;
        for (; next < sides_.size() && sides_[next].cells == side.cells &&
               sides_[next].from == side.from && sides_[next].to == side.to;
             ++next) {
          sum += sides_[next].sense;
        }
        auto& list = sum > 0 ? ahead : back;
        list.insert(list.end(), std::size_t(std::abs(sum)), side);
      }
      first = next;
      for (std::size_t i = 0; i < std::min(ahead.size(), back.size()); ++i) {
        const Side &one = ahead[i], &other = back[i];
        const Vector3 along = at_vertex(one.to) - at_vertex(one.from);
        look_beyond(static_cast<std::uint32_t>(one.cells >> 32U), one.from, along);
        look_beyond(static_cast<std::uint32_t>(one.cells), one.to, along);
        if (one.from != other.from) add_triangle(one.to, one.from, other.from);
        if (one.to != other.to) add_triangle(one.to, other.from, other.to);
      }
    }
  }

  /// A side of a sheet that is run through with the sheet to its left has the rim to its right.
  void look_beyond(std::uint32_t cell, std::uint32_t vertex, const Vector3& along) {
    const auto found = split_.find(cell);
    if (found == split_.end()) return;
    Sheets& sheets = found->second;
    sheets.beyond += along.cross(vertex == sheets.vertices[0] ? sheets.across : -sheets.across);
  }

  const AssetView& asset_;
  double cell_ = 1;
  Cell counts_{};  ///< of cells
  Vector3 origin_ = Vector3::Zero();
  std::vector<float> reach_;  ///< of corners: how far the surface is at least, m, below 0 inside
  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> cells_;                 ///< the number of each cell that is crossed
  std::vector<Cell> owners_;                         ///< the cells, by that number
  std::unordered_map<std::uint32_t, Sheets> split_;  ///< by that number: cells with two vertices
  std::vector<std::uint32_t> quads_;                 ///< vertices, four for each crossing
  std::vector<Side> sides_;
  ContourMesh mesh_;
};

}  // namespace

ContourMesh contour_mesh(const AssetView& asset, int cells) {
  return Contour(asset, std::max(1, cells)).make();
}

}  // namespace spm
