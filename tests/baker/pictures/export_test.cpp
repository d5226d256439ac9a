// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/export.hpp"

#include <catch2/catch.hpp>

namespace spm::baker::export_test {

namespace {

ContourMesh two_triangles() {
  ContourMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.5F, 0, 0}, {0, 0.25F, 0}, {0, 0, 1}};
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  return mesh;
}

}  // namespace

TEST_CASE("A PLY of text has a line for each vertex and for each triangle") {
  CHECK_THAT(
      to_ply(two_triangles(), true),
      Catch::Contains("element vertex 4\n") && Catch::Contains("element face 2\n") &&
          Catch::EndsWith("end_header\n0 0 0\n0.5 0 0\n0 0.25 0\n0 0 1\n3 0 1 2\n3 0 2 3\n"));
}

TEST_CASE("A binary PLY has 12 bytes for each vertex and 13 for each triangle") {
  const std::string ply = to_ply(two_triangles(), false);
  const std::size_t head = ply.find("end_header\n") + 11;
  CHECK(ply.size() == head + 4 * 12 + 2 * 13);
  CHECK(ply[head + 4 * 12] == 3);
}

}  // namespace spm::baker::export_test
