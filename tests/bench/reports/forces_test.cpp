// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/bench/reports/force_errors.hpp"
#include "tests/bench/reports/forces_text.hpp"
#include "tests/bench/reports/slide_paths.hpp"
#include "tests/support/shapes.hpp"

namespace forces_test {

namespace {

using namespace spm;
using namespace spm::bench;

constexpr double depth = 1e-3;       // m: 1 N at 1 N/mm
constexpr double turn = 0.1 / 20.0;  // rad a tick: 0.1 mm on a ball of 20 mm

Vector3 around(double angle) { return {std::cos(angle), std::sin(angle), 0}; }

/// A point slid around a ball.
std::vector<ExactTick> ball_ticks(int count) {
  std::vector<ExactTick> ticks;
  for (int i = 0; i < count; ++i) {
    ExactTick tick;
    tick.distance = -depth;
    tick.outward = around(turn * i);
    ticks.push_back(tick);
  }
  return ticks;
}

std::vector<Vector3> exact_forces(const std::vector<ExactTick>& ticks) {
  std::vector<Vector3> forces;
  for (const ExactTick& tick : ticks) forces.push_back(exact_penalty(tick, 1e3, 0));
  return forces;
}

const double ball_step = 2 * std::sin(turn / 2);  // N, of the exact force around the ball

}  // namespace

TEST_CASE("The exact penalty pushes out by depth times stiffness, a ball from its surface") {
  ExactTick tick;
  tick.outward = Vector3::UnitZ();
  tick.distance = -1e-3;
  CHECK((exact_penalty(tick, 1e3, 0) - Vector3::UnitZ()).norm() < 1e-12);
  CHECK((exact_penalty(tick, 1e3, 0.5e-3) - 1.5 * Vector3::UnitZ()).norm() < 1e-12);
  tick.distance = 0.2e-3;
  CHECK(exact_penalty(tick, 1e3, 0).isZero(0));
  CHECK((exact_penalty(tick, 1e3, 0.5e-3) - 0.3 * Vector3::UnitZ()).norm() < 1e-12);
  tick.distance = 0.6e-3;
  CHECK(exact_penalty(tick, 1e3, 0.5e-3).isZero(0));
}

TEST_CASE("The exact forces themselves have no error and no excess step") {
  const std::vector<ExactTick> ticks = ball_ticks(500);
  const ForceErrors errors = force_errors(ticks, exact_forces(ticks), {});
  CHECK(errors.relative() == 0);
  CHECK(errors.exact_rms == Approx(1));
  CHECK(errors.direction.max < 1e-9);
  CHECK(errors.step.max == Approx(ball_step));
  CHECK(errors.excess.count == 499);
  CHECK(errors.excess.max == 0);
}

TEST_CASE("A force off by a share, or turned by an angle, differs by it") {
  const std::vector<ExactTick> ticks = ball_ticks(500);
  std::vector<Vector3> larger = exact_forces(ticks), turned;
  for (Vector3& force : larger) force *= 1.02;
  const ForceErrors scaled = force_errors(ticks, larger, {});
  CHECK(scaled.relative() == Approx(0.02));
  CHECK(scaled.direction.max < 1e-9);
  for (int i = 0; i < 500; ++i) turned.push_back(around(turn * i + 0.03));
  const ForceErrors angles = force_errors(ticks, turned, {});
  CHECK(angles.relative() == Approx(2 * std::sin(0.015)));
  CHECK(angles.direction.p50 == Approx(0.03));
  CHECK(angles.excess.max == Approx(0).margin(1e-12));
}

TEST_CASE("A step that the exact force does not make is excess") {
  const std::vector<ExactTick> ticks = ball_ticks(2000);
  std::vector<Vector3> forces = exact_forces(ticks);
  // One patch of the surface stands 0.2 rad askew.
  for (std::size_t i = 1000; i < 1100; ++i) forces[i] = around(turn * static_cast<double>(i) + 0.2);
  const ForceErrors errors = force_errors(ticks, forces, {});
  CHECK(errors.excess.max == Approx(2 * std::sin((0.2 + turn) / 2) - ball_step));
  CHECK(errors.excess.p99 == Approx(0).margin(1e-12));
  CHECK(errors.excess.count == 1999);
}

TEST_CASE("Steps are not counted where the exact force jumps, the path begins anew or lifts") {
  std::vector<ExactTick> ticks = ball_ticks(100);
  for (std::size_t i = 50; i < 100; ++i) ticks[i].outward = -ticks[i].outward;
  ticks[20].fresh = true;
  ticks[30].sliding = false;
  const ForceErrors errors = force_errors(ticks, std::vector<Vector3>(100, Vector3::Zero()), {});
  // Of 99: neither the fresh one nor the two about the lifted; then not the jump.
  CHECK(errors.step.count == 96);
  CHECK(errors.excess.count == 95);
  CHECK(errors.missing == 100);
  CHECK(errors.relative() == Approx(1));
}

TEST_CASE("Ticks by the medial axis, beside holes and deeper than the band are not judged") {
  std::vector<ExactTick> ticks = ball_ticks(100);
  std::vector<Vector3> forces = exact_forces(ticks);
  ticks[10].contested = ticks[11].contested = true;
  ticks[12].distance = -3e-3;
  ticks[13].distance = 1e-3;
  for (std::size_t i = 10; i < 14; ++i) forces[i] = -forces[i];
  const JudgedTicks counts = count_judged(ticks, 2e-3, 0);
  CHECK(counts.contacts == 99);
  CHECK(counts.contested == 2);
  CHECK(counts.deep == 1);
  CHECK(counts.judged == 96);
  const ForceErrors errors = force_errors(ticks, forces, {});
  CHECK(errors.relative() == 0);
  CHECK(errors.spurious == 1);
  CHECK(errors.clear_excess.max == 0);
}

TEST_CASE("A walked slide stays at its depth in a ball, 0.1 mm a tick") {
  const Model model({"ball", "ball", 100e-6}, test::as_mesh(test::sphere(0.02, 4)));
  const SlidePath path = walked_slide(model, depth, 400, 1);
  REQUIRE(path.points.size() == 400);
  CHECK(path.ticks.front().fresh);
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    CHECK(path.ticks[i].distance == Approx(-depth).margin(2e-5));
    CHECK((path.ticks[i].outward - path.points[i].normalized()).norm() < 0.1);
    CHECK((path.points[i] - path.points[i - 1]).norm() < 1.01e-4);
  }
  CHECK(walked_slide(model, depth, 400, 1).points == path.points);
}

TEST_CASE("A recorded slide takes its phases from the file beside it") {
  const Model model({"ball", "ball", 100e-6}, test::as_mesh(test::sphere(0.02, 3)));
  const test::TemporaryFolder folder;
  const std::string file = folder.write("slide.txt", "0 0 0.03\n0 0 0.019\n0 0.0001 0.019\n");
  CHECK(recorded_slide(model, file, 0).ticks[0].sliding);
  static_cast<void>(folder.write("slide.phase.txt", "1\n0\n0\n"));
  const SlidePath path = recorded_slide(model, file, 0);
  REQUIRE(path.points.size() == 3);
  CHECK_FALSE(path.ticks[0].sliding);
  CHECK(path.ticks[1].sliding);
  CHECK(path.ticks[0].distance > 0.0095);
  CHECK(path.ticks[1].distance == Approx(-depth).margin(2e-4));
  CHECK(recorded_slide(model, file, 2).points.size() == 2);
  static_cast<void>(folder.write("slide.phase.txt", "1\n0\n"));
  CHECK_THROWS_WITH(recorded_slide(model, file, 0), Catch::Contains("line 3"));
}

TEST_CASE("A trace has a line a tick and a column group a method") {
  ForceTrace trace;
  trace.model = "ball";
  trace.path.points.assign(3, Vector3(0, 0, 0.019));
  trace.path.ticks = ball_ticks(3);
  trace.series.push_back({"spm", 0, 0, exact_forces(trace.path.ticks)});
  trace.series.push_back({"spm", 0, 120, exact_forces(trace.path.ticks)});
  trace.series.push_back({"proxy", 0.5e-3, 0, exact_forces(trace.path.ticks)});
  const std::string text = to_csv(trace, {});
  CHECK(std::count(text.begin(), text.end(), '\n') == 4);
  CHECK_THAT(
      text,
      Catch::Contains(
          "exact_z,spm_x,spm_y,spm_z,spm_limited_x,spm_limited_y,spm_limited_z,proxy_ball_x"));
  CHECK_THAT(text, Catch::Contains("\n0.001,0.000000000,0.000000000,0.019000000,-0.001000000,1,"));
}

}  // namespace forces_test
