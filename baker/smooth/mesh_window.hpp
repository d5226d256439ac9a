// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "baker/smooth/surface_mesh.hpp"

namespace spm::baker {

/// A mesh with its neighbourhoods. Immutable; any number of threads may read it.
class MeshNeighbours {
 public:
  /// A triangle seen from one of its corners, anticlockwise.
  struct Corner {
    std::uint32_t next, last;  ///< the other corners
    double to_next, to_last;   ///< lengths of the sides from here, m
    double across;             ///< of the third one
    double twice_area;         ///< m2
  };
  /// The other end of an edge.
  struct Neighbour {
    std::uint32_t vertex;
    double length2;  ///< m2
    double area;     ///< a third of the edge's triangles, m2
  };

  /// `fixed` vertices stay where they are and end every window. At `bent` vertices the mesh is not
  /// flat. One flag for each vertex. The mesh must outlive this.
  MeshNeighbours(const SurfaceMesh& surface_mesh, const MeshEdges& edges, std::vector<char> fixed,
                 std::vector<char> bent);

  [[nodiscard]] const SurfaceMesh& surface_mesh() const { return surface_mesh_; }
  [[nodiscard]] bool fixed(std::uint32_t vertex) const { return fixed_[vertex] != 0; }
  [[nodiscard]] bool bent(std::uint32_t vertex) const { return bent_[vertex] != 0; }
  [[nodiscard]] std::span<const Corner> corners(std::uint32_t vertex) const {
    return std::span(corners_).subspan(first_corner_[vertex],
                                       first_corner_[vertex + 1] - first_corner_[vertex]);
  }
  [[nodiscard]] std::span<const Neighbour> neighbours(std::uint32_t vertex) const {
    return std::span(neighbours_)
        .subspan(first_neighbour_[vertex], first_neighbour_[vertex + 1] - first_neighbour_[vertex]);
  }

 private:
  void add_corners();
  void add_neighbours(const MeshEdges& edges);

  const SurfaceMesh& surface_mesh_;
  std::vector<char> fixed_, bent_;
  std::vector<std::uint32_t> first_corner_, first_neighbour_;
  std::vector<Corner> corners_;
  std::vector<Neighbour> neighbours_;
};

/// The window of a filter around a vertex. It is unrolled along the mesh from triangle to
/// triangle, so that nothing beyond a silhouette and no other layer of surface can come into it.
/// Each thread needs its own.
class MeshWindow {
 public:
  explicit MeshWindow(const MeshNeighbours& neighbours);

  /// Where eq. 16 moves a vertex: to the mean of the mesh around it, weighted by the Gaussian of
  /// the distance along the mesh. The window ends at the nearest fixed vertex, and the kernel
  /// narrows with it. Metres. Empty where the vertex is fixed or the mesh is flat all over the
  /// window.
  [[nodiscard]] std::optional<Vector3> smoothed(std::uint32_t vertex, double sigma);

  /// The vertices that are within `distance` metres of a bent one along the mesh, as flags. Around
  /// the other vertices the mesh is flat.
  [[nodiscard]] std::vector<char> near_bends(double distance);

 private:
  using Entry = std::pair<double, std::uint32_t>;

  /// Goes outwards from the vertices whose distances were offered, up to `limit` metres. With
  /// `fixed_end` it stops at the first fixed vertex. Returns how far it came.
  [[nodiscard]] double explore(double limit, bool fixed_end);
  void forget();
  void pass_on(std::uint32_t vertex);
  void pass_across(double near, double far, const MeshNeighbours::Corner& corner, double arm,
                   double side, std::uint32_t to);
  void offer(std::uint32_t vertex, double distance);

  const MeshNeighbours& neighbours_;
  std::vector<double> distance_;      ///< along the mesh from the start, infinite where unknown
  std::vector<char> settled_;         ///< the distance is final
  std::vector<std::uint32_t> known_;  ///< vertices with a distance, to be reset afterwards
  std::vector<std::uint32_t> window_;
  std::vector<Entry> heap_;
};

}  // namespace spm::baker
