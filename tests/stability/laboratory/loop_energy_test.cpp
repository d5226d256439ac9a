// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/loop_energy.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace spm::stability::loop_energy_test {
namespace {

/// A force field without memory.
template <class Field>
class FieldLaw final : public Contestant {
 public:
  explicit FieldLaw(Field field) : field_(field) {}
  void begin(const Vector3&) override {}
  ContactForce next(const Vector3& measured, const Vector3&) override {
    ContactForce contact;
    contact.force = field_(measured);
    return contact;
  }

 private:
  Field field_;
};

StabilityCase rounded() {
  StabilityCase tried;
  tried.name = "sphere";
  tried.shape = test::sphere(0.015, 2);
  tried.tolerance = 50e-6;
  tried.max_depth = 2e-3;
  return tried;
}

double path_length(const ClosedLoop& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    sum += (loop.points[(i + 1) % loop.points.size()] - loop.points[i]).norm();
  }
  return sum;
}

TEST_CASE("A field that turns about an axis gains its curl times the loop's area") {
  ClosedLoop loop;
  for (int i = 0; i < 5000; ++i) {
    const double turn = 2 * std::numbers::pi * i / 5000;
    loop.points.emplace_back(1e-3 * std::cos(turn), 1e-3 * std::sin(turn), 0);
  }
  FieldLaw turning([](const Vector3& p) { return Vector3(-100 * p.y(), 100 * p.x(), 7); });
  // Curl 200 N/m over pi mm2.
  CHECK(loop_work(turning, loop, 1e-6) == Approx(200 * std::numbers::pi * 1e-6).epsilon(1e-4));
  FieldLaw central([](const Vector3& p) { return Vector3(-500 * p); });
  CHECK(std::abs(loop_work(central, loop, 1e-6)) < 1e-15);
}

TEST_CASE("Loops are closed, of the length asked for, and as deep as asked for at a flat place") {
  StabilityCase tried;
  tried.name = "box";
  tried.shape = test::box(Vector3::Constant(0.06));
  LoopPlan plan;
  plan.loops = 12;
  plan.step = 20e-6;
  const auto loops = closed_loops(tried, plan);
  REQUIRE(loops.size() == 12);
  for (const ClosedLoop& loop : loops) {
    CHECK(path_length(loop) == Approx(10e-3).epsilon(2e-3));
    const double out = loop.from.cwiseAbs().maxCoeff();
    CHECK(out == Approx(0.03 + plan.min_depth));
  }
}

TEST_CASE("The exact penalty gains nothing on closed loops, and the product little") {
  LoopPlan plan;
  plan.loops = 4;
  const LoopEnergy exact = loop_energy(rounded(), {"exact-penalty", {}}, plan);
  CHECK(exact.loops == 4);
  // A jump of 0.1 N from facet to facet, half a step, some ten of them.
  CHECK(exact.largest_j < 1e-6);
  CHECK(exact.largest_j >= exact.median_j);
  // Neighbouring leaves of the octree may differ by twice the tolerance.
  CHECK(loop_energy(rounded(), {"spm", {}}, plan).largest_j < 30e-6);
}

}  // namespace
}  // namespace spm::stability::loop_energy_test
