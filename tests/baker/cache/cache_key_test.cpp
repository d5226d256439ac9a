// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/cache_key.hpp"

#include <catch2/catch.hpp>
#include <functional>

namespace spm::baker::cache_key_test {
namespace {

BuildRequest request_of(const std::string& mesh = "teeth.obj") {
  BuildRequest request;
  request.mesh = mesh;
  request.output = "teeth.spm.exr";
  return request;
}

std::string digest(const BuildRequest& request) { return cache_key(request, "abc").digest; }

}  // namespace

TEST_CASE("Each option that changes an asset changes its key") {
  const auto [name, change] = GENERATE(table<std::string, std::function<void(BuildRequest&)>>({
      {"form", [](BuildRequest& r) { r.bake.form = AssetForm::full; }},
      {"tolerance", [](BuildRequest& r) { r.bake.tolerance = 1e-4; }},
      {"max-depth", [](BuildRequest& r) { r.bake.max_depth = 1e-3; }},
      {"margin", [](BuildRequest& r) { r.bake.margin = 1e-3; }},
      {"probe", [](BuildRequest& r) { r.bake.probe_radius = 1e-4; }},
      {"workspace", [](BuildRequest& r) { r.bake.workspace = OrientedBox{}; }},
      {"kind", [](BuildRequest& r) { r.bake.kind = PlaneKind::vertex; }},
      {"planes", [](BuildRequest& r) { r.bake.planes = 20; }},
      {"resolution", [](BuildRequest& r) { r.bake.resolution = 9; }},
      {"layers", [](BuildRequest& r) { r.bake.layers = Layers::scalar; }},
      {"layer limit", [](BuildRequest& r) { r.bake.layer_limit = 2; }},
      {"smooth", [](BuildRequest& r) { r.bake.smooth.kind = Smoothing::gaussian; }},
      {"sigma", [](BuildRequest& r) { r.bake.smooth.sigma = 1e-4; }},
      {"angle", [](BuildRequest& r) { r.bake.smooth.angle = 0.5; }},
      {"directions", [](BuildRequest& r) { r.bake.direction_tolerance = 0.1; }},
      {"max-bytes", [](BuildRequest& r) { r.bake.max_bytes = 1000000; }},
      {"seed", [](BuildRequest& r) { r.bake.seed = 2; }},
      {"unit", [](BuildRequest& r) { r.load.unit = 1e-3; }},
      {"diagonal", [](BuildRequest& r) { r.load.fit_diagonal = 0.1; }},
      {"inexact", [](BuildRequest& r) { r.allow_inexact = true; }},
      {"the kind of the mesh's file", [](BuildRequest& r) { r.mesh = "teeth.ply"; }},
  }));
  INFO(name);
  BuildRequest changed = request_of();
  change(changed);
  CHECK(digest(changed) != digest(request_of()));
}

TEST_CASE("Other mesh bytes change the key, but paths, threads and time limits do not") {
  CHECK(cache_key(request_of(), "abc").digest != cache_key(request_of(), "abd").digest);
  BuildRequest elsewhere = request_of("/somewhere/else.OBJ");
  elsewhere.output = "/tmp/other.spm.exr";
  elsewhere.bake.threads = 7;
  elsewhere.time_limit = 5;
  elsewhere.limits.device = "falcon";  // what it gives is in the other options by now
  CHECK(digest(elsewhere) == digest(request_of()));
}

TEST_CASE("A file's own unit is another than any that is named, where files of its kind have one") {
  BuildRequest named = request_of("a.3mf"), plain = request_of("a.obj");
  named.load.unit = plain.load.unit = 1;
  CHECK(digest(named) != digest(request_of("a.3mf")));
  CHECK(digest(plain) == digest(request_of("a.obj")));
}

TEST_CASE("What changed between two keys is told by name") {
  BuildRequest changed = request_of();
  changed.bake.max_depth = 0.001;
  const auto before = cache_key(request_of(), "abc").parts;
  CHECK(difference(before, cache_key(request_of(), "abc").parts).empty());
  CHECK(difference(before, cache_key(changed, "abd").parts) ==
        "the mesh's bytes changed, max_depth was 0.002 and is 0.001");
  auto older = before;
  older["algorithm_version"] = 0;
  CHECK_THAT(difference(older, before), Catch::StartsWith("algorithm_version was 0 and is "));
}

}  // namespace spm::baker::cache_key_test
