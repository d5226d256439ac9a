// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/shards.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include "baker/batch/cost.hpp"
#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::shards_test {
namespace {

/// A manifest of meshes of sizes that differ widely.
Manifest manifest_in(const test::Folder& folder, int assets) {
  for (int i = 0; i < assets; ++i) {
    folder.write("m" + std::to_string(i) + ".obj",
                 std::string(static_cast<std::size_t>(1000 * (1 + i * i % 37)), 'x'));
  }
  auto manifest = read_manifest(
      folder.write("assets.toml", "[[asset]]\nmesh = \"m*.obj\"\noutput = \"{stem}.spm.exr\"\n"));
  REQUIRE(manifest);
  return *manifest;
}

double cost_of(const Manifest& part) {
  double cost = 0;
  for (const ManifestEntry& entry : part.entries) cost += estimated_cost(entry.request);
  return cost;
}

}  // namespace

TEST_CASE("A shard is read as I/N, and what is out of range is refused") {
  const auto shard = parse_shard("3/8");
  REQUIRE(shard);
  CHECK(shard->index == 3);
  CHECK(shard->count == 8);
  for (const char* text : {"", "3", "0/8", "9/8", "3/0", "-1/8", "3/8/2", "3 / 8", "a/b", "1/",
                           "/4", "1/99999999999", "+1/2", "1/1000001"}) {
    INFO(text);
    const auto refused = parse_shard(text);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ExitCode::usage);
  }
}

TEST_CASE("Every asset is in exactly one shard, in the manifest's order, the same each time") {
  const test::Folder folder;
  const Manifest manifest = manifest_in(folder, 60);
  const unsigned count = GENERATE(1U, 2U, 7U, 60U, 100U);
  const Manifest read_again = manifest_in(folder, 60);
  std::multiset<std::string> seen;
  for (unsigned index = 1; index <= count; ++index) {
    const Manifest part = part_of(manifest, {index, count});
    const Manifest again = part_of(read_again, {index, count});
    REQUIRE(again.entries.size() == part.entries.size());
    std::vector<std::string> outputs;
    for (const ManifestEntry& entry : part.entries) outputs.push_back(entry.output);
    for (std::size_t i = 0; i < outputs.size(); ++i) CHECK(again.entries[i].output == outputs[i]);
    CHECK(std::is_sorted(outputs.begin(), outputs.end()));
    seen.insert(outputs.begin(), outputs.end());
  }
  CHECK(seen.size() == 60);
  CHECK(std::set<std::string>(seen.begin(), seen.end()).size() == 60);
}

TEST_CASE("Shards cost about the same") {
  const test::Folder folder;
  const Manifest manifest = manifest_in(folder, 60);
  std::vector<double> costs;
  for (unsigned index = 1; index <= 4; ++index)
    costs.push_back(cost_of(part_of(manifest, {index, 4})));
  const auto [least, most] = std::minmax_element(costs.begin(), costs.end());
  CHECK(*most < 1.05 * *least);
  CHECK(shards_of({5, 1, 1, 1, 1, 1}, 2) == std::vector<unsigned>{1, 2, 2, 2, 2, 2});
}

TEST_CASE("A larger mesh, a finer tolerance and a missing mesh are estimated as such") {
  const test::Folder folder;
  BuildRequest small, large, none;
  small.mesh = folder.write("small.obj", std::string(10'000, 'x'));
  large.mesh = folder.write("large.obj", std::string(1'000'000, 'x'));
  none.mesh = folder.path("none.obj");
  CHECK(estimated_cost(large) > 2 * estimated_cost(small));
  CHECK(estimated_memory(large) > estimated_memory(small));
  CHECK(estimated_cost(none) > 0);
  BuildRequest fine = large;
  large.bake.tolerance = 1e-4;
  fine.bake.tolerance = 1e-5;
  CHECK(estimated_cost(fine) > estimated_cost(large));
}

TEST_CASE(
    "Memory is estimated as no less than was measured, of large meshes as less than twice that") {
  // Balls of models/rough.py at 100 um: bytes of the file and of the bake's memory at its peak.
  const std::vector<std::pair<std::uintmax_t, double>> measured{
      {856'720, 0.146e9}, {3'883'541, 0.268e9}, {42'179'783, 1.2e9}, {221'731'247, 5.97e9}};
  const test::Folder folder;
  for (const auto& [file, memory] : measured) {
    BuildRequest request;
    request.mesh = folder.write("ball.obj", "");
    std::filesystem::resize_file(request.mesh, file);
    CHECK(estimated_memory(request) > memory);
    if (memory > 1e9) CHECK(estimated_memory(request) < 2 * memory);
  }
}

}  // namespace spm::baker::shards_test
