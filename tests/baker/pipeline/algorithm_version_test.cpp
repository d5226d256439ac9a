// SPDX-License-Identifier: GPL-3.0-or-later
// Caches give old bytes for as long as the version of the algorithm stands.
#include "baker/pipeline/algorithm_version.hpp"

#include <catch2/catch.hpp>
#include <functional>

#include "baker/build/build.hpp"
#include "formats/asset/asset.hpp"
#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::algorithm_version_test {
namespace {

/// A step of two boxes: edges that turn in and out, and coordinates that floats hold exactly.
constexpr const char* step = R"(v 0 0 0
v 0.0625 0 0
v 0.0625 0.03125 0
v 0 0.03125 0
v 0 0 0.0625
v 0.03125 0 0.0625
v 0.03125 0 0.03125
v 0.0625 0 0.03125
v 0 0.03125 0.0625
v 0.03125 0.03125 0.0625
v 0.03125 0.03125 0.03125
v 0.0625 0.03125 0.03125
f 1 4 3 2
f 1 2 8 7
f 1 7 6 5
f 4 11 12 3
f 4 9 10 11
f 1 5 9 4
f 2 3 12 8
f 7 8 12 11
f 6 7 11 10
f 5 6 10 9
)";

/// The corner of a cube, since a full asset of the step takes long.
constexpr const char* corner = R"(v 0 0 0
v 0.0625 0 0
v 0 0.0625 0
v 0 0 0.0625
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
)";

std::string digest_of(const char* mesh, const std::function<void(BuildRequest&)>& set) {
  const test::Folder folder;
  BuildRequest request;
  request.mesh = folder.write("m.obj", mesh);
  request.output = folder.path("m.spm.exr");
  request.bake.max_depth = 0.0078125;
  request.bake.margin = 0.00390625;
  set(request);
  return run_build(request, {}).json["content_sha256"].get<std::string>();
}

}  // namespace

TEST_CASE("What a bake writes changes only with its version") {
  // A new version of the algorithm or of the format, or other digests: first raise
  // algorithm_version where the digests differ and the format is the same, then write all of them
  // down here.
  CHECK(algorithm_version == 16);
  CHECK(asset_format_version == 13);
  CHECK(digest_of(step, [](BuildRequest& request) { request.bake.tolerance = 2.5e-4; }) ==
        "856bba181d5f242ccaedda4f34ed62a07d008b3a94535a25959bf4c0012d2431");
  CHECK(digest_of(corner, [](BuildRequest& request) {
          request.bake.form = AssetForm::full;
          request.bake.planes = 6;
          request.bake.resolution = 5;
        }) == "95e28729778d1bc18078b208ee2e6b5295702a97352fab5e7b29908140ed1005");
}

}  // namespace spm::baker::algorithm_version_test
