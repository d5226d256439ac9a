// SPDX-License-Identifier: Apache-2.0
#include "servo/force/sampled_tool.hpp"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "tests/support/asset_by_hand.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::sampled_tool_test {
namespace {

using test::SparseCubeByHand;

/// The form of a tool whose surface is triangles alone; it lies within a cube of 24 mm.
struct Form {
  const char* name;
  test::Shape shape;
};

std::vector<Form> forms() {
  return {{"sphere", test::sphere(0.008, 2)},
          {"peg", test::cylinder(0.003, 0.022, 32)},
          {"plate", test::plate({0.02, 0.012, 0.001})},
          {"bar", test::box({0.021, 0.003, 0.0047})},
          {"torus", test::torus(0.008, 0.0025, 24, 12)}};
}

std::size_t samples_of(const AssetView& asset, std::size_t most) {
  ToolSettings settings;
  settings.samples = most;
  const auto made = SampledTool::make(asset, settings, 1, 1);
  INFO((made ? "" : made.error().message));
  REQUIRE(made.has_value());
  return (*made)->samples().levels.back().count;
}

TEST_CASE("A tool has at most so many samples as are asked for, and not far fewer") {
  for (const Form& form : forms()) {
    SparseCubeByHand asset(0.024);
    asset.replace_triangles(form.shape);
    for (const std::size_t most : {6, 10, 50, 100, 333, 1000, 2500}) {
      CAPTURE(form.name, most);
      const std::size_t count = samples_of(asset.view, most);
      CHECK(count <= most);
      if (most >= 50) CHECK(2 * count >= most);
    }
  }
}

TEST_CASE("A cube, whose faces take up samples in squares, has the largest square that fits") {
  const SparseCubeByHand cube(0.012);
  for (const std::size_t most : {6, 23, 24, 53, 54, 96, 100, 1000, 1080, 1090, 3000, 20'000}) {
    CAPTURE(most);
    const std::size_t count = samples_of(cube.view, most);
    CHECK(count <= most);
    if (most >= 54) CHECK(2 * count >= most);
  }
}

TEST_CASE("Fewer samples than a tool can have are refused by the name of their key") {
  const SparseCubeByHand cube(0.012);
  ToolSettings settings;
  settings.samples = 5;
  const auto few = SampledTool::make(cube.view, settings, 1, 1);
  REQUIRE_FALSE(few.has_value());
  CHECK(few.error().code == ExitCode::invalid_input);
  CHECK(few.error().message.find("'samples'") != std::string::npos);
  CHECK(few.error().message.find("needs 6 samples") != std::string::npos);
}

}  // namespace
}  // namespace spm::sampled_tool_test
