// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/depfile.hpp"

#include <catch2/catch.hpp>

#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::depfile_test {

TEST_CASE("A dep-file names what each output is made from, and spells odd names") {
  const std::string text = depfile_text({{"out a.exr", {"m$1.obj", "b:c#.toml"}}});
  CHECK(text == "out\\ a.exr: \\\n  m$$1.obj \\\n  b\\:c\\#.toml\nb\\:c\\#.toml:\nm$$1.obj:\n");
}

TEST_CASE("An asset is made from its mesh, its scene and the manifest") {
  Manifest manifest;
  manifest.path = "assets.toml";
  ManifestEntry entry;
  entry.request.mesh = "m.obj";
  entry.request.output = "baked/m.spm.exr";
  entry.request.limits.scene = "scene.toml";
  manifest.entries = {entry};
  manifest.searched_folders = {"./meshes", "baked"};
  const auto found = dependencies_of(manifest);
  REQUIRE(found.size() == 1);
  CHECK(found[0].inputs ==
        std::vector<std::string>{"m.obj", "scene.toml", "assets.toml", "./meshes"});
}

TEST_CASE("A dep-file that is right is left alone") {
  const test::Folder folder;
  const std::string path = folder.path("assets.d");
  REQUIRE(write_depfile(path, {{"a", {"b"}}}));
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(9);
  std::filesystem::last_write_time(path, long_ago);
  REQUIRE(write_depfile(path, {{"a", {"b"}}}));
  CHECK(std::filesystem::last_write_time(path) == long_ago);
  REQUIRE(write_depfile(path, {{"a", {"c"}}}));
  CHECK(std::filesystem::last_write_time(path) != long_ago);
}

}  // namespace spm::baker::depfile_test
