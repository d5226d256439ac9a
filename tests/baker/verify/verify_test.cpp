// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/verify.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "formats/files/sha256.hpp"
#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/support/triangle_octree.hpp"

namespace verify_test {

using namespace spm;
using namespace spm::baker;

namespace {

/// Of the lattice on which corners lie, m.
constexpr double lattice_step = 2e-6;

/// An asset of every triangle of a shape: its answers are exact for the shape that it was made of,
/// if that lies on the lattice.
Asset exact_asset(const test::Shape& shape, double tolerance, ListSide side = ListSide::surface) {
  const Mesh mesh = test::as_mesh(shape);
  Asset asset;
  asset.metadata.diagonal = mesh.diagonal;
  asset.metadata.band = {0.002, 0.0005};
  asset.metadata.tolerance = tolerance;
  asset.octree = test::triangle_octree(shape, {.low = Vector3::Constant(-0.1), .edge = 0.2},
                                       lattice_step, side);
  return asset;
}

VerifyReport verify(const test::Shape& truth, const Asset& asset, VerifyOptions options) {
  const AssetTables tables = tables_of(asset);
  options.samples = 4000;
  return verify_against(test::as_mesh(truth), tables.view(), asset.metadata, options);
}

VerifyReport verify(const test::Shape& truth, const Asset& asset, unsigned threads = 0) {
  VerifyOptions options;
  options.threads = threads;
  return verify(truth, asset, options);
}

VerifyReport verify_with_worst(const test::Shape& truth, const Asset& asset, std::size_t worst) {
  VerifyOptions options;
  options.worst = worst;
  return verify(truth, asset, options);
}

/// The same of a sheet, felt at its middle.
Asset sheet_asset(const test::Shape& shape, double tolerance) {
  Asset asset = exact_asset(shape, tolerance);
  for (std::uint32_t& word : asset.octree.sides) {
    const std::uint32_t sheet = pack_traits({.sides = 0x1555});
    word = sheet | sheet << 16U;
  }
  // What was listed as of solids is of sheets.
  for (std::size_t word = 1; word < asset.octree.words.size(); word += 2) {
    const std::uint32_t listed = asset.octree.words[word] & max_listed_of_kind;
    asset.octree.words[word] = list_word(0, listed, ListSide::surface, false);
  }
  return asset;
}

/// A box without its lid.
test::Shape open_box() {
  test::Shape shape = test::box({0.05, 0.04, 0.03});
  shape.triangles.resize(10);
  return shape;
}

test::Shape box() { return test::box({0.05, 0.04, 0.03}); }

}  // namespace

TEST_CASE("An asset that is exact verifies as exact") {
  for (const test::Shape& any :
       {box(), test::sphere(0.03, 2), test::torus(0.03, 0.01, 24, 12),
        test::merged(test::sphere(0.02, 2), test::turned_inside_out(test::sphere(0.01, 1)))}) {
    const test::Shape shape = test::on_lattice(any, lattice_step);
    const VerifyReport report = verify(shape, exact_asset(shape, 50e-6));
    CHECK(report.samples == 4000);
    CHECK(report.distance.max < 1e-8);
    CHECK(report.direction_max < 0.01);
    CHECK(report.inside_as_outside == 0);
    CHECK(report.outside_as_inside == 0);
    CHECK(report.unanswered == 0);
    CHECK(report.not_judged == 0);
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
  asset.octree.root_words = {test::root_word(OctreeKind::far, 0)};
  const VerifyReport report = verify(box(), asset);
  CHECK(report.unanswered > 0.9);  // near the margin `far` is an answer
  CHECK(report.unanswered < 1);
  CHECK(report.inside_as_outside > 0.7);
  CHECK(report.outside_as_inside == 0);
}

TEST_CASE("A deep answer where it is shallow is off by the difference") {
  // An asset of a box so large that all of the band is deep in it.
  const Asset asset = exact_asset(test::box({0.09, 0.09, 0.09}), 50e-6, ListSide::inside);
  const VerifyReport report = verify(box(), asset);
  CHECK(report.unanswered == 0);
  CHECK(report.distance.max == Approx(0.0025).epsilon(0.01));
  CHECK(report.outside_as_inside > 0.15);
}

TEST_CASE("Samples reach the whole band and no farther") {
  // An asset of a box so large that all of the band is deep in it.
  const Asset asset = exact_asset(test::box({0.09, 0.09, 0.09}), 50e-6, ListSide::inside);
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

TEST_CASE("An asset that keeps its tolerance everywhere passes") {
  const VerifyReport report = verify(box(), exact_asset(box(), 50e-6));
  CHECK(report.passed());
  CHECK(report.missed() == 0);
  CHECK(report.judged() == report.samples + report.adversarial.samples);
  CHECK(report.counts.wrong_side == 0);
  CHECK(report.tolerance == 50e-6);
  CHECK(report.seed == 1);
}

TEST_CASE("An asset that is off by more than its tolerance does not pass, and the places count") {
  const VerifyReport report = verify(box(), exact_asset(test::moved(box(), {100e-6, 0, 0}), 90e-6));
  CHECK_FALSE(report.passed());
  CHECK(report.counts.unanswered == 0);
  CHECK(report.counts.beyond_tolerance > 100);
  CHECK(report.counts.beyond_tolerance < 4000);
  CHECK(report.missed() ==
        report.counts.beyond_tolerance + report.adversarial.counts.beyond_tolerance);
}

TEST_CASE("Counts are the shares times the samples") {
  Asset asset = exact_asset(box(), 50e-6);
  asset.octree.root_words = {test::root_word(OctreeKind::far, 0)};
  const VerifyReport report = verify(box(), asset);
  CHECK_FALSE(report.passed());
  CHECK(static_cast<double>(report.counts.unanswered) == Approx(report.unanswered * 4000));
  CHECK(report.counts.wrong_side > 2000);
  CHECK(report.counts.beyond_tolerance == 0);
}

TEST_CASE("A place on the wrong side is beyond the tolerance too, or has no answer") {
  const VerifyReport report =
      verify_with_worst(box(), exact_asset(test::turned_inside_out(box()), 50e-6), 10000);
  CHECK(report.counts.wrong_side > 3800);
  CHECK(report.missed() >= report.counts.wrong_side + report.adversarial.counts.wrong_side);
  for (const WorstPlace& place : report.worst) {
    if (place.kind == Finding::wrong_side) REQUIRE(place.error.value() > 50e-6);
  }
  CHECK(std::any_of(report.worst.begin(), report.worst.end(),
                    [](const WorstPlace& place) { return place.kind == Finding::wrong_side; }));
}

TEST_CASE("The worst places are as many as asked, sorted, and where the asset is wrong") {
  const Asset asset = exact_asset(test::moved(box(), {100e-6, 0, 0}), 90e-6);
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{50}}) {
    CHECK(verify_with_worst(box(), asset, count).worst.size() == count);
  }
  // More than there are: all of them.
  const VerifyReport all = verify_with_worst(box(), asset, 10000);
  CHECK(all.worst.size() == all.judged());
  for (std::size_t i = 1; i < all.worst.size(); ++i) {
    REQUIRE(all.worst[i - 1].error.value() >= all.worst[i].error.value());
  }
  CHECK(all.worst.front().error == std::max(all.distance.max, all.adversarial.distance.max));
  CHECK(all.worst.front().kind == Finding::beyond_tolerance);
  CHECK(std::abs(all.worst.front().point.x()) > 0.02);
  CHECK(all.worst.back().kind == Finding::within);
  const std::vector<WorstPlace> few = verify(box(), asset).worst;
  for (std::size_t i = 0; i < few.size(); ++i) CHECK(few[i].point == all.worst[i].point);
}

TEST_CASE("Places without an answer come first among the worst and have no error") {
  Asset asset = exact_asset(test::moved(box(), {100e-6, 0, 0}), 90e-6);
  // The half where x is above 0 is outside the octree.
  asset.octree.origin.x() = -asset.octree.edge;
  const VerifyReport report = verify_with_worst(box(), asset, 10000);
  const std::uint64_t unanswered = report.counts.unanswered + report.adversarial.counts.unanswered;
  REQUIRE(unanswered > 100);
  REQUIRE(unanswered < report.judged());
  for (std::size_t i = 0; i < report.worst.size(); ++i) {
    const WorstPlace& place = report.worst[i];
    REQUIRE((place.kind == Finding::unanswered) == (i < unanswered));
    REQUIRE(place.error.has_value() == (i >= unanswered));
    if (i < unanswered) REQUIRE(place.point.x() >= 0);
  }
}

TEST_CASE("The worst places are the same for any number of threads") {
  const Asset asset = exact_asset(test::moved(box(), {30e-6, 20e-6, 0}), 25e-6);
  const VerifyReport one = verify(box(), asset, 1);
  const VerifyReport two = verify(box(), asset, 2);
  REQUIRE(one.worst.size() == two.worst.size());
  for (std::size_t i = 0; i < one.worst.size(); ++i) {
    CHECK(one.worst[i].point == two.worst[i].point);
    CHECK(one.worst[i].error == two.worst[i].error);
    CHECK(one.worst[i].hard == two.worst[i].hard);
  }
}

TEST_CASE("An asset that promises nothing passes, and its errors still count") {
  Asset asset = exact_asset(test::moved(box(), {100e-6, 0, 0}), 90e-6);
  asset.metadata.tolerance.reset();
  const VerifyReport report = verify(box(), asset);
  CHECK(report.passed());
  CHECK_FALSE(report.tolerance);
  CHECK(report.threshold == Approx(asset.metadata.diagonal / 1000));
  CHECK(report.missed() > 0);
}

TEST_CASE("Places that the bake left out are not judged, and with nothing else there is no pass") {
  Asset asset = exact_asset(box(), 50e-6);
  asset.octree.root_words = {test::root_word(OctreeKind::pruned, 0)};
  const VerifyReport report = verify(box(), asset);
  CHECK(report.counts.pruned == 4000);
  CHECK(report.missed() == 0);
  CHECK(report.judged() == 0);
  CHECK(report.worst.empty());
  CHECK_FALSE(report.passed());
}

TEST_CASE("Contested directions are judged against the nearest of those that compete") {
  // A plate so thin that the middle of its band is as near to one side as to the other.
  const test::Shape plate = test::plate({0.05, 0.04, 0.0005});
  const VerifyReport exact = verify(plate, exact_asset(plate, 200e-6));
  CHECK(exact.direction_contested > 0.1);
  CHECK(exact.contested_max < 0.01);
  const Eigen::AngleAxisd tilt(std::numbers::pi / 180, Vector3::UnitZ());
  test::Shape tilted = box();
  for (Vector3& vertex : tilted.vertices) vertex = tilt * vertex;
  const VerifyReport report = verify(box(), exact_asset(tilted, 200e-6));
  CHECK(report.contested_max > 0.01);
}

TEST_CASE("Beside a sheet all places are judged, on both sides of it") {
  const test::Shape shape = open_box();
  Asset asset = sheet_asset(shape, 50e-6);
  const VerifyReport exact = verify(shape, asset);
  CHECK(exact.samples == 4000);
  CHECK(exact.not_judged == 0);
  CHECK(exact.missed() == 0);
  asset.octree.root_words = {test::root_word(OctreeKind::far, 0)};
  CHECK(verify(shape, asset).counts.unanswered > 2000);
  const VerifyReport off = verify(shape, sheet_asset(test::moved(shape, {0, 0, 100e-6}), 90e-6));
  CHECK(off.missed() > 100);
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
