// SPDX-License-Identifier: Apache-2.0
#include "servo/view/mesh_bytes.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>

namespace spm::servo::mesh_bytes_test {

TEST_CASE("A mesh's bytes are its counts, vertices and corners") {
  ContourMesh mesh;
  mesh.vertices = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  mesh.triangles = {0, 1, 2};
  const std::string bytes = to_bytes(mesh);
  REQUIRE(bytes.size() == 8 + 36 + 12);
  std::array<std::uint32_t, 2> counts{};
  std::memcpy(counts.data(), bytes.data(), 8);
  CHECK(counts == std::array<std::uint32_t, 2>{3, 1});
  float last = 0;
  std::memcpy(&last, bytes.data() + 40, 4);
  CHECK(last == 9);
}

}  // namespace spm::servo::mesh_bytes_test
