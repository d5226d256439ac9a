// SPDX-License-Identifier: Apache-2.0
#include "servo/view/surface_mesh.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "common/query/query.hpp"

namespace spm::servo {

namespace {

constexpr int block = 8;       // cells along a block's edge, which is skipped as a whole
constexpr int halvings = 12;   // of a grid's edge, to find its crossing
constexpr double pull = 0.02;  // to the mean of the crossings, where their planes say nothing
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

using Cell = std::array<int, 3>;

/// What was left out by the bake lies in closed hollows.
bool is_inside(const Answer& answer) noexcept {
  if (answer.status == Status::far) return false;
  return answer.status != Status::exact || answer.distance < 0;
}

/// Sums over the crossings of one cell: the quadratic error of the distances to their planes.
struct Crossings {
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  Vector3 right = Vector3::Zero(), sum = Vector3::Zero();
  int count = 0;

  void add(const Vector3& place, const Vector3& normal) noexcept {
    square += normal * normal.transpose();
    right += normal.dot(place) * normal;
    sum += place;
    ++count;
  }
  [[nodiscard]] Vector3 best() const noexcept {
    const Vector3 mean = sum / count;
    const Eigen::Matrix3d held = square + pull * Eigen::Matrix3d::Identity();
    return held.ldlt().solve(right + pull * mean);
  }
};

class Contour {
 public:
  Contour(const AssetView& asset, int cells) : asset_(asset) {
    const Extent box = extent_of(asset);
    cell_ = box.size.maxCoeff() / cells;
    for (int axis = 0; axis < 3; ++axis) {
      // A cell more on each side, so that the surface never meets the end of the grid.
      counts_[axis] = static_cast<int>(std::ceil(box.size[axis] / cell_)) + 2;
    }
    origin_ = box.low - Vector3::Constant(cell_);
    inside_.resize(corners(), 0);
    cells_.resize(corners(), none);
  }

  SurfaceMesh make() {
    for (int z = 0; z <= counts_[2]; z += block) {
      for (int y = 0; y <= counts_[1]; y += block) {
        for (int x = 0; x <= counts_[0]; x += block) look_at({x, y, z});
      }
    }
    for (int axis = 0; axis < 3; ++axis) cross_edges(axis);
    for (std::size_t i = 0; i < crossings_.size(); ++i) place_vertex(i);
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

  /// Finds the sides of the corners of a block, which mostly is far from the surface.
  void look_at(const Cell& first) {
    const Vector3 middle = place(first) + Vector3::Constant(cell_ * (block - 1) / 2.0);
    const double reach = cell_ * block * std::sqrt(3.0) / 2;
    if (!asset_.full && clearance(asset_, middle) > reach) return;
    Cell last;
    for (int axis = 0; axis < 3; ++axis) {
      last[axis] = std::min(first[axis] + block - 1, counts_[axis]);
    }
    for (int z = first[2]; z <= last[2]; ++z) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int x = first[0]; x <= last[0]; ++x) {
          inside_[at({x, y, z})] = is_inside(query_point(asset_, place({x, y, z}))) ? 1 : 0;
        }
      }
    }
  }

  /// Finds the edges along an axis that the surface crosses, and spans a quadrangle between the
  /// four cells about each.
  void cross_edges(int axis) {
    const int left = (axis + 1) % 3, up = (axis + 2) % 3;
    for (int z = 1; z < counts_[2]; ++z) {
      for (int y = 1; y < counts_[1]; ++y) {
        for (int x = 1; x < counts_[0]; ++x) {
          const Cell from{x, y, z};
          Cell to = from;
          ++to[axis];
          const bool enters = inside_[at(from)] == 0 && inside_[at(to)] != 0;
          const bool leaves = inside_[at(from)] != 0 && inside_[at(to)] == 0;
          if (!enters && !leaves) continue;
          std::array<Cell, 4> about{from, from, from, from};
          --about[1][left];
          --about[2][left];
          --about[2][up];
          --about[3][up];
          cross(enters ? to : from, enters ? from : to, about, enters);
        }
      }
    }
  }

  void cross(const Cell& inner, const Cell& outer, const std::array<Cell, 4>& about, bool enters) {
    Vector3 in = place(inner), out = place(outer);
    for (int i = 0; i < halvings; ++i) {
      const Vector3 middle = (in + out) / 2;
      (is_inside(query_point(asset_, middle)) ? in : out) = middle;
    }
    const Answer answer = query_point(asset_, in);
    std::array<std::uint32_t, 4> quad{};
    for (std::size_t i = 0; i < about.size(); ++i) quad[i] = crossings_of(about[i]);
    for (const std::uint32_t cell : quad) crossings_[cell].add(in, answer.normal);
    if (enters) std::swap(quad[1], quad[3]);
    mesh_.triangles.insert(mesh_.triangles.end(),
                           {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
  }

  std::uint32_t crossings_of(const Cell& cell) {
    std::uint32_t& number = cells_[at(cell)];
    if (number == none) {
      number = static_cast<std::uint32_t>(crossings_.size());
      crossings_.emplace_back();
      owners_.push_back(cell);
    }
    return number;
  }

  /// The best place may lie far from a cell that is almost flat.
  void place_vertex(std::size_t number) {
    const Vector3 low = place(owners_[number]);
    const Vector3 best = crossings_[number].best();
    const Vector3 held = best.cwiseMax(low).cwiseMin(low + Vector3::Constant(cell_));
    mesh_.vertices.push_back(
        {static_cast<float>(held[0]), static_cast<float>(held[1]), static_cast<float>(held[2])});
  }

  const AssetView& asset_;
  double cell_ = 1;
  Cell counts_{};  ///< of cells
  Vector3 origin_ = Vector3::Zero();
  std::vector<std::uint8_t> inside_;  ///< of corners
  std::vector<std::uint32_t> cells_;  ///< the number of each cell that is crossed
  std::vector<Crossings> crossings_;  ///< by that number
  std::vector<Cell> owners_;          ///< the cells, by that number
  SurfaceMesh mesh_;
};

template <class T>
void append(std::string& bytes, const T* first, std::size_t count) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(first), count * sizeof(T));
}

}  // namespace

SurfaceMesh surface_mesh(const AssetView& asset, int cells) {
  return Contour(asset, std::max(1, cells)).make();
}

std::string to_bytes(const SurfaceMesh& mesh) {
  std::string bytes;
  const std::array<std::uint32_t, 2> counts{static_cast<std::uint32_t>(mesh.vertices.size()),
                                            static_cast<std::uint32_t>(mesh.triangles.size() / 3)};
  bytes.reserve(8 + 12 * mesh.vertices.size() + 4 * mesh.triangles.size());
  append(bytes, counts.data(), counts.size());
  append(bytes, mesh.vertices.data(), mesh.vertices.size());
  append(bytes, mesh.triangles.data(), mesh.triangles.size());
  return bytes;
}

}  // namespace spm::servo
