// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/bake_folder.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/support/shapes.hpp"

namespace bake_folder_test {

namespace {

using namespace spm;
using namespace spm::bench;

Model sphere_model(double radius, char hash) {
  baker::Mesh mesh = test::as_mesh(test::sphere(radius, 2));
  mesh.sha256 = std::string(64, hash);
  return {{"sphere", "sphere", 400e-6}, std::move(mesh)};
}

TEST_CASE(
    "A kept asset is taken up with the time of its bake, but not for another mesh or tolerance") {
  const TemporaryFolder folder;
  const std::string kept = folder.path() + "/bakes";
  const Model model = sphere_model(0.01, '0');
  const BakedFile baked = BakeFolder(kept).asset(model, 400e-6);
  const auto written = std::filesystem::last_write_time(baked.path);

  const BakedFile again = BakeFolder(kept).asset(model, 400e-6);
  CHECK(again.path == baked.path);
  CHECK(std::filesystem::last_write_time(again.path) == written);
  CHECK(again.bytes == baked.bytes);
  CHECK(again.seconds == Approx(baked.seconds).epsilon(1e-4));
  CHECK(again.settings == baked.settings);

  CHECK(BakeFolder(kept).asset(model, 200e-6).path != baked.path);
  CHECK(BakeFolder(kept).asset(sphere_model(0.012, '1'), 400e-6).path != baked.path);
}

TEST_CASE("An asset without the note that its bake came to an end is baked again") {
  const TemporaryFolder folder;
  const Model model = sphere_model(0.01, '0');
  const BakedFile baked = BakeFolder(folder.path()).asset(model, 400e-6);
  std::filesystem::remove(baked.path + ".seconds");
  std::filesystem::resize_file(baked.path, 10);
  CHECK(BakeFolder(folder.path()).asset(model, 400e-6).bytes == baked.bytes);
  CHECK(std::filesystem::file_size(baked.path) == baked.bytes);
}

TEST_CASE("Without a folder to keep them in the assets go with the mode") {
  std::string path;
  {
    const BakeFolder bakes("");
    path = bakes.asset(sphere_model(0.01, '0'), 400e-6).path;
    CHECK(std::filesystem::exists(path));
  }
  CHECK_FALSE(std::filesystem::exists(path));
}

}  // namespace

}  // namespace bake_folder_test
