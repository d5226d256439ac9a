// SPDX-License-Identifier: Apache-2.0
#include "common/contact/force_law.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/support/asset_by_hand.hpp"

namespace spm::force_law_test {
namespace {

using test::BoxByHand;

const Vector3 size(0.04, 0.05, 0.06);

TEST_CASE("Both methods press a point out of a box by stiffness times depth") {
  const BoxByHand box(size);
  for (const Method method : {Method::spm, Method::paper}) {
    const ContactForce force =
        contact_force(box.view, {method, PaperRule::closest_plane, 800, 0}, {0.001, 0.002, 0.0288});
    CHECK(force.contact);
    CHECK_FALSE(force.deep);
    CHECK(force.depth == Approx(0.0012));
    CHECK((force.force - Vector3(0, 0, 0.96)).norm() < 1e-5);
    CHECK(force.force.norm() == Approx(800 * force.depth));
  }
}

TEST_CASE("A sphere touches before its centre does") {
  const BoxByHand box(size, {0.002, 0.0015});
  const ForceSettings settings{Method::spm, PaperRule::closest_plane, 1000, 0.001};
  const ContactForce touching = contact_force(box.view, settings, {0, 0, 0.0304});
  CHECK(touching.contact);
  CHECK(touching.depth == Approx(0.0006));
  CHECK_FALSE(contact_force(box.view, settings, {0, 0, 0.0311}).contact);
}

TEST_CASE("Deeper than the band the force saturates and never drops") {
  const BoxByHand box(size);
  const ForceSettings settings{Method::spm, PaperRule::closest_plane, 1000, 0};
  const ContactForce force = contact_force(box.view, settings, {0, 0, 0.025});
  CHECK(force.deep);
  CHECK(force.depth == 0.002);
  CHECK(force.force.norm() == Approx(2.0));
}

TEST_CASE("A point that is not finite, or a map that is not, gives no force") {
  BoxByHand box(size);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Method method : {Method::spm, Method::paper}) {
    CHECK(contact_force(box.view, {method, PaperRule::closest_plane, 1000, 0}, {nan, 0, 0})
              .force.isZero());
  }
  for (test::MapByHand& made : box.by_hand) {
    std::fill(made.samples.begin(), made.samples.end(), std::numeric_limits<float>::quiet_NaN());
  }
  box.refresh();
  for (const Method method : {Method::spm, Method::paper}) {
    const ContactForce force =
        contact_force(box.view, {method, PaperRule::closest_plane, 1000, 0}, {0, 0, 0.029});
    CHECK(force.force.isZero());
    CHECK_FALSE(force.contact);
  }
}

}  // namespace
}  // namespace spm::force_law_test
