// SPDX-License-Identifier: GPL-3.0-or-later
// What a bake promises is judged by the answers that whoever opens the file is served.
#include <tbb/parallel_for.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/build/build.hpp"
#include "baker/cast/cast.hpp"
#include "baker/mesh/load.hpp"
#include "baker/surface/outer_surface.hpp"
#include "common/query/query.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/baker/build/band_trials.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::served_answers_test {
namespace {

constexpr double tolerance = 1e-4;
constexpr std::uint64_t places = 300'000;

/// A capsule from one point to another, faceted: a ball whose half is moved along.
test::Shape capsule(const Vector3& from, const Vector3& to, double radius) {
  test::Shape shape = test::sphere(radius, 1);
  const Vector3 along = to - from;
  for (Vector3& vertex : shape.vertices) vertex += vertex.dot(along) > 0 ? to : from;
  return shape;
}

/// A chain of capsules about as thick as the band is deep, so that its medial axis lies in the
/// band; 0.1 m from corner to corner.
test::Shape capsule_chain() {
  test::Shape chain;
  Vector3 from(-0.03, -0.03, -0.025);
  constexpr int limbs = 3;
  for (int i = 0; i < limbs; ++i) {
    const double turn = 2.1 * i;
    const double height = -0.025 + 0.05 * (i + 1) / limbs;
    const Vector3 to(0.035 * std::cos(turn), 0.035 * std::sin(turn), height);
    const double radius = 1.2e-3 + 0.8e-3 * i / (limbs - 1);
    chain = i == 0 ? capsule(from, to, radius) : test::merged(chain, capsule(from, to, radius));
    from = to;
  }
  return chain;
}

}  // namespace

TEST_CASE(
    "An asset that is written answers everywhere in the band of limbs as thick as it is deep") {
  const test::TemporaryFolder folder;
  BuildRequest request;
  request.mesh = folder.path("chain.obj");
  request.output = folder.path("chain.spm.exr");
  test::write_obj(capsule_chain(), request.mesh);
  request.bake.tolerance = tolerance;
  request.load.fit_diagonal = 0.1;
  REQUIRE_NOTHROW(run_build(request, {}));
  const auto asset = MappedAsset::open(request.output);
  REQUIRE(asset.has_value());
  const AssetView& view = (*asset)->view();
  const OuterSurface surface = outer_surface(load_mesh(request.mesh, request.load));
  const Caster caster(surface);
  const BandTrials band(caster, view.band, view.tolerance, 11);
  std::atomic<std::uint64_t> unanswered = 0, wrong_side = 0, off = 0;
  tbb::parallel_for(std::uint64_t{0}, places, [&](std::uint64_t i) {
    const Vector3 point = band.point(i);
    const double truth = caster.closest(point).distance;
    if (truth > view.band.margin || truth < -view.band.max_depth) return;
    const Answer answer = query_point(view, point);
    if (!std::isfinite(answer.distance)) {
      ++unanswered;
    } else if (std::abs(answer.distance - truth) > tolerance) {
      ++(std::abs(truth) > tolerance && (answer.distance < 0) != (truth < 0) ? wrong_side : off);
    }
  });
  CHECK(unanswered == 0);
  CHECK(wrong_side == 0);
  CHECK(off == 0);
}

TEST_CASE("Beside an edge that runs into a gap, places before the gap are outside") {
  // The top of a block falls away by 6 um along an edge from where it meets the bottom of another
  // block, which hangs over half of the edge: half of it lies in a gap that is not felt.
  const auto top = [](double x, double y) { return 2e-3 * x - 3e-4 * (0.01 - y); };
  test::Shape block = test::moved(test::box({0.01, 0.02, 0.01}), {-0.005, 0, -0.005});
  for (Vector3& vertex : block.vertices) {
    if (vertex.z() > -0.001) vertex.z() = top(vertex.x(), vertex.y());
  }
  const test::Shape over = test::moved(test::box({0.02, 0.017, 0.01}), {0, 0.0065, 0.005});
  const test::TemporaryFolder folder;
  BuildRequest request;
  request.mesh = folder.path("blocks.obj");
  request.output = folder.path("blocks.spm.exr");
  // Elsewhere there is a gap of which walls stay open at their ends.
  const test::Shape gap =
      test::merged(test::moved(test::box({0.01, 0.01, 0.01}), {0.03, 0, 0}),
                   test::moved(test::box({0.006, 0.006, 0.01}), {0.03, 0.001, 0.010001}));
  test::write_obj(test::merged(test::merged(block, over), gap), request.mesh);
  request.bake.tolerance = 2e-4;
  request.allow_inexact = true;
  REQUIRE_NOTHROW(run_build(request, {}));
  const auto asset = MappedAsset::open(request.output);
  REQUIRE(asset.has_value());
  std::size_t wrong = 0;
  for (int i = 0; i < 400; ++i) {
    const double y = -0.0095 + 0.007 * i / 400, turn = 0.05 + 1.4 * (i % 20) / 20;
    const Vector3 edge(0, y, top(0, y));
    const Vector3 place = edge + 3e-4 * Vector3(std::cos(turn), 0, std::sin(turn));
    const Answer answer = query_point((*asset)->view(), place);
    wrong += answer.distance > 0 ? 0 : 1;
  }
  CHECK(wrong == 0);
}

}  // namespace spm::baker::served_answers_test
