// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/float_mesh.hpp"

#include <cstddef>

namespace spm::bench {

FloatMesh::FloatMesh(const baker::OuterSurface& surface) {
  constexpr std::uint32_t unused = 0xFFFFFFFFU;
  std::vector<std::uint32_t> place(surface.vertices.size(), unused);
  triangles.reserve(surface.solid_count);
  for (std::size_t i = 0; i < surface.solid_count; ++i) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& vertex = place[surface.triangles[i][k]];
      if (vertex == unused) {
        vertex = static_cast<std::uint32_t>(vertices.size());
        const Vector3& position = surface.vertices[surface.triangles[i][k]];
        vertices.push_back({static_cast<float>(position.x()), static_cast<float>(position.y()),
                            static_cast<float>(position.z())});
      }
      corners[k] = vertex;
    }
    triangles.push_back(corners);
  }
}

}  // namespace spm::bench
