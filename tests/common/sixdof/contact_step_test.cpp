// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/contact_step.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "tests/support/random.hpp"

namespace spm::contact_step_test {
namespace {

using test::RandomTwister;

constexpr double lever = 0.03;

Matrix6 coupling() {
  Matrix6 stiffness = Matrix6::Zero();
  stiffness.diagonal() << 1000, 1000, 1000, 1, 1, 1;
  return stiffness;
}

NearContact plane(const Vector3& normal, const Vector3& arm, double distance) {
  NearContact made;
  const Vector3 turn = arm.cross(normal);
  for (std::size_t k = 0; k < 3; ++k) {
    made.along[k] = static_cast<float>(normal[static_cast<Eigen::Index>(k)]);
    made.along[3 + k] = static_cast<float>(turn[static_cast<Eigen::Index>(k)]);
  }
  made.distance = static_cast<float>(distance);
  made.spring = 5e5F;
  return made;
}

/// What is left of all forces after a step, N and N m.
Vector6 left_over(const Vector6& wrench, const std::vector<NearContact>& contacts,
                  const Vector6& step) {
  Vector6 left = wrench - coupling() * step;
  for (const NearContact& contact : contacts) {
    Vector6 along;
    for (std::size_t k = 0; k < 6; ++k)
      along[static_cast<Eigen::Index>(k)] = double{contact.along[k]};
    const double distance = double{contact.distance} + along.dot(step);
    if (distance < 0) left -= double{contact.spring} * distance * along;
  }
  return left;
}

TEST_CASE("Without contacts a step goes to where the coupling's force ends") {
  Vector6 wrench;
  wrench << 1, 0, -2, 0.01, 0, 0;
  const Vector6 step = contact_step(wrench, coupling(), {}, 1, lever);
  CHECK((step - Vector6(coupling().inverse() * wrench)).norm() < 1e-12);
}

TEST_CASE("No part of a step is longer than the longest, along and about") {
  Vector6 wrench;
  wrench << 1, 0, 0, 0, 0, 0;
  constexpr double longest = 1e-6;
  // By 1 mm it would be in balance; by fifteen parts it comes 15 um far.
  CHECK(contact_step(wrench, coupling(), {}, longest, lever)[0] == Approx(15 * longest));
  wrench << 0, 0, 0, 0, 0.05, 0;
  CHECK(lever * contact_step(wrench, coupling(), {}, longest, lever)[4] == Approx(15 * longest));
}

TEST_CASE("A plane ahead that does not touch yet is known before a step, and carries the load") {
  const std::vector<NearContact> contacts{plane(Vector3::UnitZ(), Vector3::Zero(), 3e-5)};
  Vector6 wrench = Vector6::Zero();
  wrench[2] = -8;  // pulled 8 mm into it
  for (const double longest : {1.0, 1e-4}) {
    const Vector6 step = contact_step(wrench, coupling(), contacts, longest, lever);
    CHECK(step[2] < -3e-5);
    CHECK(step[2] > -6e-5);
    CHECK(left_over(wrench, contacts, step).norm() < 1e-3);
  }
}

TEST_CASE("A step ends in balance with many planes, by random") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomTwister random(seed);
    std::vector<NearContact> contacts;
    for (int k = 0; k < 60; ++k) {
      const Vector3 normal = (Vector3::UnitZ() + random.vector(0.8)).normalized();
      contacts.push_back(plane(normal, random.vector(lever), random.between(-1e-5, 6e-5)));
    }
    Vector6 wrench;
    wrench << random.vector(2), random.vector(0.05);
    const Vector6 step = contact_step(wrench, coupling(), contacts, 1e-4, lever);
    // Far from balance only where the longest steps did not lead there.
    const Vector6 left = left_over(wrench, contacts, step);
    const auto energy = [&](const Vector6& at) {
      double sum = at.dot(coupling() * at) / 2 - wrench.dot(at);
      for (const NearContact& contact : contacts) {
        Vector6 along;
        for (std::size_t k = 0; k < 6; ++k)
          along[static_cast<Eigen::Index>(k)] = double{contact.along[k]};
        const double below = std::min(0.0, double{contact.distance} + along.dot(at));
        sum += double{contact.spring} / 2 * below * below;
      }
      return sum;
    };
    REQUIRE(energy(step) <= energy(Vector6::Zero()));
    const Vector6 further = step + 1e-7 * left / std::max(left.norm(), 1e-12);
    INFO("seed " << seed << ", left " << left.transpose());
    REQUIRE((left.head<3>().norm() < 0.02 || energy(further) < energy(step)));
  }
}

TEST_CASE("What touches before a step is the sum of its springs") {
  const std::vector<NearContact> contacts{plane(Vector3::UnitX(), Vector3(0, 0.01, 0), -2e-5),
                                          plane(Vector3::UnitY(), Vector3::Zero(), 1e-6)};
  const ContactSum sum = pressed_now(contacts);
  CHECK(sum.wrench[0] == Approx(10));
  CHECK(sum.wrench[5] == Approx(-0.1));
  CHECK(sum.energy == Approx(1e-4));
  CHECK(sum.stiffness(0, 5) == Approx(-5000));
}

}  // namespace
}  // namespace spm::contact_step_test
