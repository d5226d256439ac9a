// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/merge.hpp"

#include <catch2/catch.hpp>

#include "formats/files/sha256.hpp"
#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::merge_test {
namespace {

/// Two shards of a batch of four assets, all baked.
class Run : public test::Folder {
 public:
  Run() {
    for (const char* name : {"a", "b", "c", "d"}) {
      write(std::string(name) + ".obj", "mesh");
      write(std::string(name) + ".spm.exr", name);
    }
    auto read = read_manifest(
        write("assets.toml", "[[asset]]\nmesh = \"*.obj\"\noutput = \"{stem}.spm.exr\"\n"));
    REQUIRE(read);
    manifest = *read;
    for (unsigned index = 1; index <= 2; ++index) {
      const Manifest part = part_of(manifest, {index, 2});
      std::vector<AssetOutcome> outcomes;
      for (const ManifestEntry& entry : part.entries) {
        AssetOutcome outcome;
        outcome.known = true;
        outcome.report = {{"content_sha256", sha256_bytes(entry.name)}};
        outcomes.push_back(outcome);
      }
      results.emplace_back("result-" + std::to_string(index),
                           result_of(part, {index, 2}, outcomes));
    }
  }

  [[nodiscard]] Result<Merged> merged() const { return merge_results(manifest, results); }

  Manifest manifest;
  std::vector<std::pair<std::string, BatchResult>> results;
};

}  // namespace

TEST_CASE("Results of all shards without a failure are complete") {
  const Run run;
  const auto merged = run.merged();
  REQUIRE(merged);
  CHECK(merged->complete());
  CHECK(merged->done.size() == 4);
}

TEST_CASE("A result survives its file") {
  Run run;
  run.results[0].second.assets[0].code = ExitCode::invalid_input;
  run.results[0].second.assets[0].error = "a mesh: is \"none\"";
  const std::string path = run.path("result.json");
  REQUIRE(write_result(path, run.results[0].second));
  const auto back = read_result(path);
  REQUIRE(back);
  CHECK(back->manifest_sha256 == run.manifest.sha256);
  CHECK(back->shard.index == 1);
  REQUIRE(back->assets.size() == 2);
  CHECK(back->assets[0].error == "a mesh: is \"none\"");
  CHECK(back->assets[1].sha256 == run.results[0].second.assets[1].sha256);
  CHECK(read_result(run.write("other.json", "{}")).error().code == ExitCode::invalid_input);
  CHECK(read_result(run.write("cut.json", "{\"spm_batch_result\": 1}")).error().code ==
        ExitCode::invalid_input);
  CHECK(read_result(run.path("none")).error().code == ExitCode::file_or_device);
}

TEST_CASE("A missing shard, and its assets, are told by name") {
  Run run;
  const std::string name = run.results[1].second.assets[0].name;
  run.results.pop_back();
  const auto merged = run.merged();
  REQUIRE(merged);
  CHECK_FALSE(merged->complete());
  CHECK(merged->missing_shards == std::vector<unsigned>{2});
  CHECK(merged->missing.size() == 2);
  CHECK(merged->missing[0] == name);
}

TEST_CASE("Failed assets, those never begun and those whose output changed are told by name") {
  Run run;
  auto& assets = run.results[0].second.assets;
  assets[0].code = ExitCode::tolerance_not_met;
  assets[0].error = "too fine";
  assets[1].begun = false;
  const std::string lost = run.results[1].second.assets[0].name;
  static_cast<void>(run.write(lost + ".spm.exr", "something else"));
  const std::string gone = run.results[1].second.assets[1].name;
  std::filesystem::remove(run.path(gone + ".spm.exr"));
  const auto merged = run.merged();
  REQUIRE(merged);
  CHECK(merged->failed ==
        std::vector<std::pair<std::string, std::string>>{{assets[0].name, "too fine"}});
  CHECK(merged->missing == std::vector<std::string>{assets[1].name});
  CHECK(merged->lost.size() == 2);
}

TEST_CASE("Results that do not belong together are refused") {
  Run run;
  SECTION("of another manifest") { run.results[1].second.manifest_sha256 = "other"; }
  SECTION("of another number of shards") { run.results[1].second.shard.count = 3; }
  SECTION("of one shard twice") { run.results[1].second.shard.index = 1; }
  SECTION("of a shard out of range") { run.results[1].second.shard.index = 3; }
  SECTION("with an asset twice") {
    run.results[1].second.assets[0] = run.results[0].second.assets[0];
  }
  SECTION("with a foreign asset") { run.results[1].second.assets[0].output = "x.spm.exr"; }
  const auto merged = run.merged();
  REQUIRE_FALSE(merged);
  CHECK(merged.error().code == ExitCode::invalid_input);
  CHECK_THAT(merged.error().message, Catch::StartsWith("result-2: "));
}

}  // namespace spm::baker::merge_test
