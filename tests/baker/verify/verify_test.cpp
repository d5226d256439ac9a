// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/verify.hpp"

#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "formats/files/sha256.hpp"
#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/support/triangle_bvh.hpp"

namespace verify_test {

using namespace spm;
using namespace spm::baker;

namespace {

/// Sets all space in and around an asset to one kind.
void fill_sign_octree(Asset& asset, SignKind kind) {
  test::fill_sign_octree(asset, Vector3::Constant(-0.1), 0.2, kind);
}

/// An asset of every triangle of a shape: its answers are exact for the shape that it was made of.
Asset exact_asset(const test::Shape& shape, double tolerance) {
  const Mesh mesh = test::as_mesh(shape);
  Asset asset;
  asset.metadata.diagonal = mesh.diagonal;
  asset.metadata.band = {0.002, 0.0005};
  asset.metadata.tolerance = tolerance;
  for (const auto& triangle : shape.triangles) {
    for (const std::uint32_t corner : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        asset.triangles.push_back(static_cast<float>(shape.vertices[corner][axis]));
      }
    }
  }
  const test::TriangleBvh tree(asset);
  fill_sign_octree(asset, SignKind::boundary);
  return asset;
}

VerifyReport verify(const test::Shape& truth, const Asset& asset, unsigned threads = 0) {
  const AssetTables tables = tables_of(asset);
  VerifyOptions options;
  options.samples = 4000;
  options.threads = threads;
  return verify_against(test::as_mesh(truth), tables.view(), asset.metadata, options);
}

test::Shape box() { return test::box({0.05, 0.04, 0.03}); }

}  // namespace

TEST_CASE("An asset that is exact verifies as exact") {
  for (const test::Shape& shape :
       {box(), test::sphere(0.03, 2), test::torus(0.03, 0.01, 24, 12),
        test::merged(test::sphere(0.02, 2), test::turned_inside_out(test::sphere(0.01, 1)))}) {
    const VerifyReport report = verify(shape, exact_asset(shape, 50e-6));
    CHECK(report.samples == 4000);
    CHECK(report.distance.max < 1e-8);
    CHECK(report.direction_max < 0.01);
    CHECK(report.inside_as_outside == 0);
    CHECK(report.outside_as_inside == 0);
    CHECK(report.unanswered == 0);
    CHECK(report.near_holes == 0);
    CHECK(report.fallback_answers > 0.99);
  }
}

TEST_CASE("An asset that is off by 100 um verifies as off by that") {
  const VerifyReport report =
      verify(box(), exact_asset(test::moved(box(), {100e-6, 0, 0}), 200e-6));
  CHECK(report.distance.max == Approx(100e-6).epsilon(0.02));
  CHECK(report.distance.p50 < 1e-8);
  CHECK(report.distance.p99 == Approx(100e-6).epsilon(0.02));
  CHECK(report.distance.p999 <= report.distance.max);
  CHECK(std::abs(report.worst_point.x()) > 0.02);
}

TEST_CASE("An asset that is tilted by a degree verifies as tilted") {
  const Eigen::AngleAxisd tilt(std::numbers::pi / 180, Vector3::UnitZ());
  test::Shape tilted = box();
  for (Vector3& vertex : tilted.vertices) vertex = tilt * vertex;
  const VerifyReport report = verify(box(), exact_asset(tilted, 50e-6));
  CHECK(report.direction_p50 == Approx(std::numbers::pi / 180).epsilon(0.02));
}

TEST_CASE("An asset that is inside out has every clear sample on the wrong side") {
  const VerifyReport report = verify(box(), exact_asset(test::turned_inside_out(box()), 50e-6));
  CHECK(report.inside_as_outside + report.outside_as_inside > 0.99);
  CHECK(report.inside_as_outside > report.outside_as_inside);
}

TEST_CASE("Places without an answer are counted, and inside they count as taken for outside") {
  Asset asset = exact_asset(box(), 50e-6);
  fill_sign_octree(asset, SignKind::far);
  const VerifyReport report = verify(box(), asset);
  CHECK(report.unanswered > 0.9);  // near the margin `far` is an answer
  CHECK(report.unanswered < 1);
  CHECK(report.inside_as_outside > 0.7);
  CHECK(report.outside_as_inside == 0);
}

TEST_CASE("A deep answer where it is shallow is off by the difference") {
  // An asset of a box so large that all of the band is deep in it.
  Asset asset = exact_asset(test::box({0.09, 0.09, 0.09}), 50e-6);
  fill_sign_octree(asset, SignKind::inside);
  const VerifyReport report = verify(box(), asset);
  CHECK(report.unanswered == 0);
  CHECK(report.distance.max == Approx(0.0025).epsilon(0.01));
  CHECK(report.outside_as_inside > 0.15);
}

TEST_CASE("Samples reach the whole band and no farther") {
  // An asset of a box so large that all of the band is deep in it.
  Asset asset = exact_asset(test::box({0.09, 0.09, 0.09}), 50e-6);
  fill_sign_octree(asset, SignKind::inside);
  const AssetTables tables = tables_of(asset);
  VerifyOptions options;
  options.samples = 4000;
  options.band = 0.001;
  const VerifyReport report =
      verify_against(test::as_mesh(box()), tables.view(), asset.metadata, options);
  CHECK(report.band.max_depth == 0.001);
  // Every answer is 2 mm inside, so the errors run from 1 mm to 2.5 mm.
  CHECK(report.distance.max == Approx(0.0025).epsilon(0.01));
  CHECK(report.distance.rms > 0.001);
}

TEST_CASE("A verification is the same for any number of threads, and another for another seed") {
  const Asset asset = exact_asset(test::moved(box(), {30e-6, 20e-6, 0}), 100e-6);
  const VerifyReport one = verify(box(), asset, 1);
  const VerifyReport two = verify(box(), asset, 2);
  CHECK(one.distance.rms == two.distance.rms);
  CHECK(one.distance.max == two.distance.max);
  CHECK(one.direction_p99 == two.direction_p99);
  CHECK(one.worst_point == two.worst_point);
  const AssetTables tables = tables_of(asset);
  VerifyOptions options;
  options.samples = 4000;
  options.seed = 2;
  const VerifyReport other =
      verify_against(test::as_mesh(box()), tables.view(), asset.metadata, options);
  CHECK(other.distance.rms != one.distance.rms);
}

TEST_CASE("Places beside a hole are left out and their share is told") {
  test::Shape shape = box();
  shape.triangles.resize(10);
  const VerifyReport report = verify(shape, exact_asset(shape, 50e-6));
  CHECK(report.near_holes > 0.01);
  CHECK(report.near_holes < 0.3);
  CHECK(report.samples == 4000);
}

TEST_CASE("Another mesh than the asset's is refused as invalid input") {
  const std::string path =
      (std::filesystem::temp_directory_path() / "spm_verify_test_box.obj").string();
  test::write_obj(box(), path);
  Asset asset = exact_asset(box(), 50e-6);
  asset.metadata.mesh_sha256 = std::string(64, '0');
  const AssetTables tables = tables_of(asset);
  const auto code_of = [&](const VerifyOptions& options) {
    try {
      (void)verify_asset(tables.view(), asset.metadata, path, options);
    } catch (const BakeError& error) {
      return error.code();
    }
    return ExitCode::done;
  };
  VerifyOptions options;
  options.samples = 10;
  CHECK(code_of(options) == ExitCode::invalid_input);
  asset.metadata.mesh_sha256 = sha256_file(path).value();
  CHECK(code_of(options) == ExitCode::done);
  options.band = 0.0021;
  CHECK(code_of(options) == ExitCode::invalid_input);
  options.band = 0.002;
  CHECK(code_of(options) == ExitCode::done);
  std::filesystem::remove(path);
}

}  // namespace verify_test
