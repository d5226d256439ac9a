// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cast/exact_tree.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>

#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::exact_tree_test {
namespace {

constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();

std::uint64_t bytes_of(const Mesh& mesh) {
  return 12 * (mesh.vertices.size() + mesh.triangles.size());
}

TEST_CASE("A tree of exact triangles takes more than they do, the same each time") {
  const Mesh box = test::mesh_of(test::box({0.05, 0.04, 0.06}));
  const Mesh ball = test::mesh_of(test::sphere(0.03, 4));
  for (const Mesh* mesh : {&box, &ball}) {
    const std::uint64_t tree = exact_tree_bytes(*mesh, any);
    CHECK(tree > bytes_of(*mesh));
    CHECK(tree < 20 * bytes_of(*mesh) + 4096);
    CHECK(exact_tree_bytes(*mesh, any) == tree);
  }
  CHECK(exact_tree_bytes(ball, any) > exact_tree_bytes(box, any));
}

TEST_CASE("No tree is built of triangles that take too much alone") {
  const Mesh ball = test::mesh_of(test::sphere(0.03, 4));
  CHECK(exact_tree_bytes(ball, bytes_of(ball)) == bytes_of(ball));
}

}  // namespace
}  // namespace spm::baker::exact_tree_test
