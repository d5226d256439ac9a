// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_effects.hpp"

#include <catch2/catch.hpp>

namespace spm::paper_effects_test {
namespace {

PaperContact touching() {
  PaperContact contact;
  contact.contact = true;
  contact.plane_depth = 0.003;
  contact.surface_distance = 0.001;
  contact.depth = 0.002;
  contact.normal = Vector3::UnitZ();
  return contact;
}

TEST_CASE("The paper's friction opposes the motion and grows with depth, not with speed (eq. 17)") {
  const Vector3 motion(3e-5, 0, -4e-5);
  const Vector3 force = paper_friction(0.5, 100, touching(), motion);
  CHECK(force.norm() == Approx(0.5 * (1 + 100 * 0.002)));
  CHECK(force.dot(motion) == Approx(-force.norm() * motion.norm()));
  CHECK((paper_friction(0.5, 100, touching(), 7 * motion) - force).norm() < 1e-12);
  CHECK(paper_friction(0.5, 0, touching(), motion).norm() == Approx(0.5));
}

TEST_CASE("Without motion or contact the paper's friction is zero") {
  CHECK(paper_friction(0.5, 100, touching(), Vector3::Zero()).isZero());
  CHECK(paper_friction(0.5, 100, PaperContact{}, {1e-5, 0, 0}).isZero());
}

TEST_CASE("The haptic force is the sum of reaction, friction and damping (eq. 18)") {
  const Vector3 damping = paper_damping(2, {0.1, 0, -0.2});
  CHECK((damping - Vector3(-0.2, 0, 0.4)).norm() < 1e-15);
  CHECK((haptic_force({0, 0, 2}, {0.1, 0, 0}, damping) - Vector3(-0.1, 0, 2.4)).norm() < 1e-15);
}

TEST_CASE("Noise on the distance map changes the force by stiffness times noise (eq. 19)") {
  const PaperContact contact = touching();
  CHECK((paper_texture_force(1000, contact, 0) - paper_force(contact, 1000)).norm() < 1e-12);
  CHECK((paper_texture_force(1000, contact, 5e-4) - Vector3(0, 0, 1.5)).norm() < 1e-12);
  CHECK((paper_texture_force(1000, contact, -5e-4) - Vector3(0, 0, 2.5)).norm() < 1e-12);
  CHECK(paper_texture_force(1000, PaperContact{}, 5e-4).isZero());
}

}  // namespace
}  // namespace spm::paper_effects_test
