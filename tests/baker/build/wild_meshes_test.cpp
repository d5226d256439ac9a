// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes as people have them: reductions of a few triangles, one cause each. The places and what is
// right there are those of their README, judged by the rules of baker/mesh/SOLID.md.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "baker/build/build.hpp"
#include "baker/verify/verify.hpp"
#include "common/query/query.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/skip.hpp"

namespace spm::baker::wild_meshes_test {
namespace {

constexpr double tolerance = 2e-4, thickness = tolerance;
constexpr double deep = -std::numeric_limits<double>::infinity();

/// A place, mm, and the signed distance there, mm, to solids or to the middle of a sheet.
struct Known {
  Vector3 place;
  double distance = 0;
  bool sheet = false;
};

struct Reduction {
  const char* file;
  std::vector<Known> places;
};

std::vector<Reduction> reductions() {
  const std::vector<Known> floor{{{30, 30, 0.1}, 0.1, true}, {{30, 30, -0.1}, 0.1, true}};
  std::vector<Known> through = floor;
  through.push_back({{-10.48, -4.643, -0.403}, 0.403, true});
  return {
      {"box_above_sheet.obj", floor},
      {"box_on_sheet.obj", floor},
      {"box_through_sheet.obj", through},
      {"two_sided_sheet_and_box.obj", floor},
      {"sheet_alone.obj", {}},
      {"soup_20.obj", {}},
      {"two_triangles.obj", {{{13.4807, 2.67331, 0.554818}, 0.7, true}}},
      {"fin_on_edge.obj", {{{0, 29.9, 50}, 0.1, true}, {{0, 30.1, 50}, 0.1, true}}},
      {"open_box.obj", {}},
      {"open_box_peg_in_mouth.obj",
       {{{7.976, -10.4445, 36.32}, 0.444}, {{8.641, 3.791, 30.48}, -1.36}}},
      {"tube_around_box.obj", {{{10.5, 4.25, 4.75}, 0.5}}},
      {"lid_on_jar_overlap.obj", {}},
      {"corner_apart.obj", {}},
      {"corners_20nm_apart.obj", {{{0, 0, 30.1}, 0.1}, {{0, 0, 29.9}, -0.1}}},
      {"corners_2um_apart.obj", {{{0, 0, 30.1}, 0.1}, {{0, 0, 29.9}, -0.1}}},
      {"face_doubled_reversed.obj", {{{0, 0, 30.1}, 0.1}, {{0, 0, 29.9}, -0.1}}},
      {"notch_fan_90.obj", {{{0.278967, 8.7e-5, 2e-5}, 0.279}, {{0.254512, 1e-6, 2e-6}, 0.2545}}},
      {"tets_all_faces_2.obj", {{{0, 0, 30.1}, 0.1}, {{10, 5, 3}, deep}}},
      {"box_on_box_gap_1um_off_middle.obj", {}}};
}

std::filesystem::path wild_folder() {
  const char* environment = std::getenv("SPM_SHARED");
  return std::filesystem::path(environment != nullptr ? environment : SPM_SHARED_FOLDER) /
         "meshes/wild/made";
}

}  // namespace

TEST_CASE("Open, torn and doubled meshes bake, keep the promise, and are felt as the rules say") {
  if (!std::filesystem::is_directory(wild_folder())) {
    SPM_SKIP("there are no meshes in " << wild_folder().string());
  }
  const test::TemporaryFolder folder;
  for (const Reduction& reduction : reductions()) {
    INFO(reduction.file);
    BuildRequest request;
    request.mesh = (wild_folder() / reduction.file).string();
    request.output = folder.path("asset.spm.exr");
    request.bake.tolerance = tolerance;
    REQUIRE_NOTHROW(run_build(request, {}));
    const auto asset = MappedAsset::open(request.output);
    REQUIRE(asset);
    VerifyOptions options;
    options.samples = 20'000;
    const VerifyReport report =
        verify_asset((*asset)->view(), (*asset)->metadata(), request.mesh, options);
    CHECK(report.passed());
    CHECK(report.not_judged == 0);
    for (const Known& known : reduction.places) {
      const Answer answer = query_point((*asset)->view(), 1e-3 * known.place);
      INFO(known.place.transpose() << " mm: " << answer.distance);
      if (known.distance == deep) {
        CHECK(answer.status == Status::deep);
        continue;
      }
      REQUIRE(answer.status == Status::exact);
      // The README's figures are rounded.
      CHECK(std::abs(answer.distance - 1e-3 * known.distance + (known.sheet ? thickness : 0)) <=
            tolerance + 1e-5);
    }
  }
}

TEST_CASE("A sheet is felt from both sides at the half-thickness that is asked for") {
  if (!std::filesystem::is_directory(wild_folder())) {
    SPM_SKIP("there are no meshes in " << wild_folder().string());
  }
  const test::TemporaryFolder folder;
  for (const AssetForm form : {AssetForm::sparse, AssetForm::full}) {
    BuildRequest request;
    request.mesh = (wild_folder() / "sheet_alone.obj").string();
    request.output = folder.path("asset.spm.exr");
    request.bake.form = form;
    if (form == AssetForm::sparse) request.bake.tolerance = 5e-5;
    request.bake.sheet_thickness = 1e-3;
    request.bake.planes = form == AssetForm::full ? std::optional<std::size_t>(6) : std::nullopt;
    REQUIRE_NOTHROW(run_build(request, {}));
    const auto asset = MappedAsset::open(request.output);
    REQUIRE(asset);
    for (const double height : {-1.3e-3, -4e-4, 4e-4, 1.3e-3}) {
      const Answer answer = query_point((*asset)->view(), {0.002, 0.003, height});
      REQUIRE(answer.status == Status::exact);
      CHECK(answer.distance == Approx(std::abs(height) - 1e-3).margin(5e-5));
      CHECK(answer.normal.z() * height > 0.99 * std::abs(height));
    }
  }
}

}  // namespace spm::baker::wild_meshes_test
