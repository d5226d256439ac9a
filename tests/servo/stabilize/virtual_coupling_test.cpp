// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/virtual_coupling.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace spm::virtual_coupling_test {
namespace {

constexpr double tick = 1e-3;

/// Force (N) on a hand at a depth (m) in a wall from which the coupling holds it back.
double felt_force(VirtualCoupling& coupling, double depth) {
  const Vector3 way(0, 0, std::max(0.0, depth));
  return (coupling.felt() * way + coupling.damped(way)).z();
}

TEST_CASE("What a coupling makes of a spring is the two in series, up to what may be felt") {
  CHECK(felt_stiffness(1000, 0) == 1000);
  CHECK(felt_stiffness(1000, 3000) == 1000);
  CHECK(felt_stiffness(1000, 1000) == Approx(800));
  for (const double stiff : {400.0, 1000.0, 3000.0}) {
    VirtualCoupling coupling({stiff, 0}, 1000, tick);
    CHECK(felt_force(coupling, 1e-3) == Approx(1e-3 * felt_stiffness(1000, stiff)));
  }
}

TEST_CASE("A coupling's damper pushes back while it is pressed, is quiet at rest, never pulls") {
  VirtualCoupling coupling({3000, 2}, 1000, tick);
  constexpr double way = 0.02 * tick;  // of a tick, at 0.02 m/s
  double depth = -1e-3, added = 0;
  const auto go = [&](int ticks, double by) {
    for (int i = 0; i < ticks; ++i) {
      depth += by;
      const double force = felt_force(coupling, depth);
      CHECK(force >= 0);
      added = force - 1000 * std::max(0.0, depth);
    }
  };
  // At a steady speed the damper b beside K_c before K_s makes b v (K_s / (K_c + K_s))^2.
  go(150, way);
  CHECK(added == Approx(2 * 0.02 / 9).epsilon(0.02));
  go(100, 0);
  CHECK(added == Approx(0).margin(1e-6));
  go(60, -way);
  CHECK(added == Approx(-2 * 0.02 / 9).epsilon(0.02));
  go(60, -way);
}

TEST_CASE("A coupling that came free relaxes, and is then pressed as a new one") {
  VirtualCoupling used({3000, 2}, 1000, tick), fresh({3000, 2}, 1000, tick);
  for (int i = 0; i < 50; ++i) (void)felt_force(used, 2e-3);
  // By its damper over its spring, 2/3 ms.
  for (int i = 0; i < 20; ++i) CHECK(felt_force(used, -1e-3) == 0);
  CHECK(felt_force(used, 1e-3) == Approx(felt_force(fresh, 1e-3)).epsilon(1e-4));
}

TEST_CASE("A coupling that was forgotten begins as a new one") {
  VirtualCoupling used({3000, 2}, 1000, tick), fresh({3000, 2}, 1000, tick);
  (void)felt_force(used, 2e-3);
  used.reset();
  CHECK(felt_force(used, 1e-3) == felt_force(fresh, 1e-3));
}

}  // namespace
}  // namespace spm::virtual_coupling_test
