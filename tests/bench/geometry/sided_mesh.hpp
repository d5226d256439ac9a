// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/query/query.hpp"
#include "tests/bench/model/float_mesh.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// The mesh of a search that names one nearest triangle, with the normals of its edges and corners
/// (weighted by angles: Baerentzen and Aanaes 2005), so that this triangle alone tells the side.
class SidedMesh {
 public:
  explicit SidedMesh(const Model& model);

  [[nodiscard]] const FloatMesh& mesh() const noexcept { return mesh_; }

  /// To work out the normals.
  [[nodiscard]] double seconds() const noexcept { return seconds_; }

  /// Of the mesh and its normals: three floats an edge of each triangle, and a vertex.
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return mesh_.bytes() + sizeof(edges_[0]) * edges_.size() +
           sizeof(corners_[0]) * corners_.size();
  }

  /// The answer at a point whose nearest triangle, or one of several, is `triangle`.
  [[nodiscard]] Answer answer(const Vector3& point, std::uint32_t triangle) const noexcept;

  /// Distance from a triangle, m.
  [[nodiscard]] double distance(const Vector3& point, std::uint32_t triangle) const noexcept;

 private:
  using Float3 = std::array<float, 3>;

  FloatMesh mesh_;
  double seconds_ = 0;
  double tie_;                                ///< m: nearer to the surface its own normal is told
  std::vector<std::array<Float3, 3>> edges_;  ///< of each triangle: from corner k to the next
  std::vector<Float3> corners_;               ///< of each vertex
};

}  // namespace spm::bench
