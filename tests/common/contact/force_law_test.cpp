// SPDX-License-Identifier: Apache-2.0
#include "common/contact/force_law.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

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

TEST_CASE("A ball by the paper has the mean of its depths, over its surface or its volume") {
  const BoxByHand box(size);
  ForceSettings settings{Method::paper, PaperRule::closest_plane, 800, 0.003};
  // Half of the ball is in the box.
  const ContactForce skin = contact_force(box.view, settings, {0.001, 0.002, 0.03});
  CHECK(skin.contact);
  CHECK(skin.depth == Approx(2 * 0.003 / 3).epsilon(0.01));
  CHECK((skin.normal - Vector3::UnitZ()).norm() < 1e-6);
  CHECK((skin.force - 800 * skin.depth * skin.normal).norm() < 1e-12);
  CHECK((skin.force -
         paper_probe_force(box.view, SphereProbe({0.001, 0.002, 0.03}, 0.003), 800).force)
            .norm() < 1e-12);
  settings.form = PaperProbeForm::volume;
  const ContactForce body = contact_force(box.view, settings, {0.001, 0.002, 0.03});
  CHECK(body.depth == Approx(3 * 0.003 / 8).epsilon(0.01));
  CHECK_FALSE(contact_force(box.view, settings, {0, 0, 0.0331}).contact);
  settings.stiffness = 0;
  const ContactForce soft = contact_force(box.view, settings, {0.001, 0.002, 0.03});
  CHECK(soft.contact);
  CHECK(soft.depth == body.depth);
  CHECK(soft.force.isZero());
}

TEST_CASE("A capsule by the paper reaches as far as it is long, along its axis") {
  const BoxByHand box(size);
  ForceSettings settings{Method::paper, PaperRule::closest_plane, 1000, 0.001};
  settings.take_probe({ProbeKind::capsule, 0.001, 0.008});
  CHECK(contact_force(box.view, settings, {0, 0, 0.0349}).contact);
  CHECK_FALSE(contact_force(box.view, settings, {0, 0, 0.0351}).contact);
  settings.probe_axis = Vector3::UnitX();
  CHECK_FALSE(contact_force(box.view, settings, {0, 0, 0.0311}).contact);
  // Half a cylinder with two half balls: pi r / 4 over the strip, 2 r / 3 over the discs.
  const double strip = 0.008 * 0.002, discs = std::numbers::pi * 1e-6;
  const double mean = (strip * std::numbers::pi * 1e-3 / 4 + discs * 2e-3 / 3) / (strip + discs);
  // Some 15 places lie across it.
  CHECK(contact_force(box.view, settings, {0, 0, 0.03}).depth == Approx(mean).epsilon(0.03));
}

TEST_CASE("A ball whose surface just meets the object does not touch it yet") {
  const BoxByHand box(size, {0.002, 0.0015});
  const Vector3 at(0, 0, 0.0304);
  const double distance = query_point(box.view, at).distance;
  ForceSettings settings{Method::spm, PaperRule::closest_plane, 1000, distance};
  CHECK_FALSE(contact_force(box.view, settings, at).contact);
  settings.probe_radius = std::nextafter(distance, 1.0);
  CHECK(contact_force(box.view, settings, at).contact);
}

TEST_CASE(
    "Where normals of a smoothed field differ, it is as much softer as their mean is shorter") {
  const test::SparseCubeByHand cube(0.04);
  const ForceSettings settings{Method::spm, PaperRule::closest_plane, 1000, 0};
  const RuntimeSmoothing smoothing{0.0003, 32};
  // 0.2 mm below two faces, near the edge between them.
  const Vector3 at(0.0198, 0.002, 0.0198);
  const SmoothedAnswer answer = smoothed_query(cube.view, smoothing, at);
  const double slope = answer.gradient.norm();
  REQUIRE(answer.known);
  REQUIRE(slope < 0.95);
  REQUIRE(slope > 0.5);
  const ContactForce force = smoothed_force(cube.view, settings, smoothing, at);
  CHECK(force.depth == Approx(-answer.distance * slope));
  CHECK((force.force + 1000 * answer.distance * answer.gradient).norm() < 1e-9);
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
