// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/entry_check.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>

#include "baker/mesh/load.hpp"
#include "baker/pipeline/bake.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/files/sha256.hpp"
#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::entry_check_test {
namespace {

std::string corner_of_cube(double edge) {
  const std::string e = std::to_string(edge);
  return "v 0 0 0\nv " + e + " 0 0\nv 0 " + e + " 0\nv 0 0 " + e +
         "\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

BuildRequest request_for(const std::string& mesh) {
  BuildRequest request;
  request.mesh = mesh;
  request.bake.tolerance = 1e-3;
  request.bake.max_depth = 10e-3;
  request.bake.margin = 5e-3;
  return request;
}

/// What a build of a mesh gives, as far as an entry has it.
Asset baked(const std::string& path) {
  const BuildRequest request = request_for(path);
  Asset asset = bake(load_mesh(path, request.load), request.bake, {}).asset;
  asset.metadata.tolerance_met = true;
  return asset;
}

struct Forgery {
  test::Folder folder;
  std::string mesh = folder.write("m.obj", corner_of_cube(0.05));
  BuildRequest request = request_for(mesh);
  CacheKey key = cache_key(request, *sha256_file(mesh));

  Result<void> checked(const Asset& asset) const {
    const std::string path = folder.path("m.spm.exr");
    REQUIRE(write_asset(asset, path));
    std::ifstream file(path, std::ios::binary);
    CacheEntry entry;
    entry.parts = key.parts;
    entry.asset.assign(std::istreambuf_iterator<char>(file), {});
    entry.asset_sha256 = sha256_bytes(entry.asset);
    return check_entry(entry, key.parts, request);
  }
};

}  // namespace

TEST_CASE("An entry of the mesh and the options that were asked for stands its check") {
  const Forgery honest;
  CHECK(honest.checked(baked(honest.mesh)));
}

TEST_CASE("An entry whose surface is another mesh's is refused, though all it says is right") {
  const Forgery forgery;
  Asset asset = baked(forgery.folder.write("other.obj", corner_of_cube(0.056)));
  asset.metadata.mesh_sha256 = *sha256_file(forgery.mesh);
  const auto checked = forgery.checked(asset);
  REQUIRE_FALSE(checked);
  CHECK(checked.error().message == "its asset misses what it promises");
}

TEST_CASE("An entry without a certificate is refused") {
  const Forgery forgery;
  Asset asset = baked(forgery.mesh);
  SECTION("none") { asset.metadata.certified.reset(); }
  SECTION("a tolerance that is not met") { asset.metadata.tolerance_met = false; }
  const auto checked = forgery.checked(asset);
  REQUIRE_FALSE(checked);
  CHECK(checked.error().message.find("no certificate") != std::string::npos);
}

}  // namespace spm::baker::entry_check_test
