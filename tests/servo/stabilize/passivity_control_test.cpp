// SPDX-License-Identifier: Apache-2.0
#include "servo/stabilize/passivity_control.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "servo/stabilize/velocity_estimate.hpp"

namespace spm::passivity_control_test {
namespace {

constexpr double tick = 1e-3;
constexpr double stiffness = 1000;  // N/m

/// What a hand that is moved in and out of a wall at z = 0 gets, J; the force of each tick acts
/// `delay` ticks later, until the next one does.
struct Moved {
  double work = 0;
  double largest_damping = 0;  ///< N s/m
};

/// `gain`: how many times as strong the wall pushes a hand that leaves: above 1 it is active. The
/// hand moves along one of the components.
template <int components = 3>
Moved moved_by(double gain, bool controlled, int delay, double encoder_step, double frequency,
               int along = 2) {
  using Control = PassivityControlOf<components>;
  Control control({static_cast<double>(delay), tick, encoder_step, 0.1, encoder_step, 0.1});
  const auto only = [along](double value) ->
      typename Control::Vector { return value * Control::Vector::Unit(along); };
  VelocityEstimate velocity(encoder_step, tick);
  constexpr int ticks = 2000;
  std::vector<double> sent;
  Moved moved;
  double last = 0, before = 0;
  for (int i = 0; i < ticks; ++i) {
    const double z = 1e-3 - 2e-3 * (1 - std::cos(2 * std::numbers::pi * frequency * tick * i)) / 2 *
                                (1 - 0.3 * std::cos(0.01 * i));
    if (static_cast<int>(sent.size()) > delay) {
      moved.work += sent[sent.size() - 1 - static_cast<std::size_t>(delay)] * (z - last);
    }
    last = z;
    const double told = encoder_step > 0 ? encoder_step * std::round(z / encoder_step) : z;
    const double speed = velocity.next({0, 0, told}).z();
    double force = 0;
    if (told < 0) {
      const double wanted = (told > before ? gain : 1) * -stiffness * told;
      force = wanted;
      if (controlled) {
        const double stored = 0.5 * stiffness * told * told;
        force = control.next(only(wanted), only(told), only(speed), stiffness, stored, 0)[along];
        if (std::abs(speed) > 0) {
          moved.largest_damping =
              std::max(moved.largest_damping, std::abs((force - wanted) / speed));
        }
      }
    } else {
      control.rest();
    }
    before = told;
    sent.push_back(force);
  }
  return moved;
}

TEST_CASE("The energy that a sampled spring makes is taken back, whatever the delay") {
  for (const int delay : {0, 1, 3}) {
    CAPTURE(delay);
    const Moved bare = moved_by(1, false, delay, 0, 5);
    const Moved controlled = moved_by(1, true, delay, 0, 5);
    CHECK(bare.work > 0);
    CHECK(controlled.work < 0.15 * bare.work);
  }
}

TEST_CASE("A wall that pushes harder out than in is braked, by no more than the cap") {
  const Moved bare = moved_by(1.1, false, 1, 0, 5);
  const Moved controlled = moved_by(1.1, true, 1, 0, 5);
  INFO("J: " << bare.work << " and " << controlled.work);
  CHECK(bare.work > 1e-3);
  CHECK(controlled.work < 0.2 * bare.work);
  CHECK(controlled.largest_damping > 1);
  CHECK(controlled.largest_damping <= 25 * (1 + 1e-9));
  // An encoder's step leaves 0.1 N T / D of damping, which is less than it would take.
  const Moved coarse = moved_by(1.1, true, 1, 1e-4, 5);
  CHECK(coarse.largest_damping <= 1 + 1e-9);
  CHECK(coarse.work < moved_by(1.1, false, 1, 1e-4, 5).work);
  CHECK(PassivityControl({1, tick, 1e-4, 0.1}).max_damping() == Approx(1));
  CHECK(PassivityControl({1, tick, 0, 0.1}).max_damping() == Approx(25));
}

TEST_CASE("A force that was not sent did no work") {
  PassivityControl all({0, tick, 0, 0.1}), none({0, tick, 0, 0.1});
  for (int i = 0; i < 10; ++i) {
    const Vector3 hand(0, 0, 1e-4 * i);
    (void)all.next({0, 0, 1}, hand, {0, 0, 0.1}, 1000, 0, 0);
    (void)none.next({0, 0, 1}, hand, {0, 0, 0.1}, 1000, 0, 0);
    none.sent(Vector3::Zero());
  }
  CHECK(all.generated() > 1e-4);
  CHECK(none.generated() == 0);
}

TEST_CASE("Of a damping force that was capped only that part counts as taken") {
  PassivityControl all({1, tick, 0, 0.1}), half({1, tick, 0, 0.1});
  Vector3 sent = Vector3::Zero();
  const Vector3 wanted(0, 0, 5), velocity(0, 0, 0.1);
  for (int i = 0; i < 5; ++i) {
    const Vector3 hand(0, 0, 1e-6 * i);
    sent = all.next(wanted, hand, velocity, 1000, 0, 0);
    CHECK(half.next(wanted, hand, velocity, 1000, 0, 0) == sent);
  }
  const double braked = (wanted - sent).norm();
  REQUIRE(braked > 1e-4);
  half.sent(sent / 2);
  // The hand rests, so that both have generated the same; the damping of the last tick, of which a
  // half was sent, has not acted yet.
  const Vector3 rest(0, 0, 4e-6);
  const double after = (wanted - all.next(wanted, rest, velocity, 1000, 0, 0)).norm();
  const double after_half = (wanted - half.next(wanted, rest, velocity, 1000, 0, 0)).norm();
  CHECK(all.generated() == half.generated());
  // What was not taken, over the next ticks.
  CHECK(after_half - after == Approx(braked / 2 / spread_ticks).epsilon(0.01));
}

TEST_CASE("However long a hand was braked, it is given no more than the credit for it") {
  PassivityControl control({0, tick, 0, 0.1});
  const Vector3 wanted(0, 0, 1);
  // 10 s against the force take 1 J from the hand.
  double z = 0;
  for (int i = 0; i < 10'000; ++i) {
    z -= 1e-4;
    CHECK(control.next(wanted, {0, 0, z}, {0, 0, -0.1}, 1000, 0, 0) == wanted);
  }
  CHECK(control.generated() == -max_credit);
  // And with it: 0.1 mJ a tick; from the second on it is braked.
  double braked = 0;
  for (int i = 0; i < 3; ++i) {
    z += 1e-4;
    braked = (control.next(wanted, {0, 0, z}, {0, 0, 0.1}, 1000, 0, 0) - wanted).norm();
  }
  CHECK(braked > 0.01);
}

TEST_CASE("A hand at rest by one encoder step is not braked, for it is given nothing") {
  constexpr double step = 64e-6;
  PassivityControl control({1, tick, step, 0.25});
  VelocityEstimate velocity(step, tick);
  double largest = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3 hand(0, 0, -1e-3 - (i % 7 < 3 ? step : 0));
    const Vector3 wanted(0, 0, -stiffness * hand.z());
    const double stored = 0.5 * stiffness * hand.z() * hand.z();
    const Vector3 sent = control.next(wanted, hand, velocity.next(hand), stiffness, stored, 0);
    if (i > 50) largest = std::max(largest, (sent - wanted).norm());
  }
  CHECK(largest < 0.01);
}

TEST_CASE("What an object that moves into a still hand does is no fault of the loop's") {
  PassivityControl control({0, tick, 0, 0.1});
  for (int i = 1; i < 500; ++i) {
    // The surface rises at 0.1 m/s under a hand that yields at half of it.
    const double hand = 5e-5 * i, surface = 1e-4 * i, depth = surface - hand;
    const Vector3 wanted(0, 0, stiffness * depth);
    const double carried = wanted.z() * 1e-4;
    const Vector3 sent = control.next(wanted, {0, 0, hand}, {0, 0, 0.05}, stiffness,
                                      0.5 * stiffness * depth * depth, carried);
    if (i > 1) CHECK((sent - wanted).norm() < 0.01);
  }
}

TEST_CASE("Energy that is generated in the turn alone is taken by the turn's damping") {
  const Moved bare = moved_by<6>(1.1, false, 1, 0, 5, 4);
  const Moved controlled = moved_by<6>(1.1, true, 1, 0, 5, 4);
  CHECK(bare.work > 1e-3);
  CHECK(controlled.work < 0.2 * bare.work);
  CHECK(controlled.largest_damping > 1);
  const WrenchPassivityControl control({1, tick, 1e-4, 0.1, 1e-5, 0.02});
  CHECK(control.max_damping(0) == Approx(1));
  CHECK(control.max_damping(1) == Approx(5));
}

TEST_CASE("A hand that does not turn is controlled as one that cannot") {
  for (const double step : {0.0, 2e-5}) {
    const Moved three = moved_by<3>(1.1, true, 1, step, 5);
    const Moved six = moved_by<6>(1.1, true, 1, step, 5);
    CHECK(three.work == six.work);
    CHECK(three.largest_damping == six.largest_damping);
  }
}

TEST_CASE("Energy that passes from the place to the turn and back is no one's to take") {
  WrenchPassivityControl whole({1, tick, 0, 0.1, 0, 0.1});
  PassivityControl place({1, tick, 0, 0.1}), turn({1, tick, 0, 0.1});
  // A contact two levers away: as the place rises the turn lets it sink, and the spring rests.
  constexpr double depth = 1e-3, arms = 2, speed = 2 * std::numbers::pi * 5;
  const Vector3 force(0, 0, stiffness * depth), torque(0, arms * stiffness * depth, 0);
  double answered = 0, answered_apart = 0;
  for (int i = 0; i < 1000; ++i) {
    const double z = 2e-3 * std::sin(speed * tick * i);
    const double rate = 2e-3 * speed * std::cos(speed * tick * i);
    const Vector3 at(0, 0, z), turned(0, -z / arms, 0), going(0, 0, rate),
        turning(0, -rate / arms, 0);
    WrenchPassivityControl::Vector wanted, hand, velocity;
    wanted << force, torque;
    hand << at, turned;
    velocity << going, turning;
    constexpr double stored = 0.5 * stiffness * depth * depth;
    answered = std::max(answered,
                        (whole.next(wanted, hand, velocity, stiffness, stored, 0) - wanted).norm());
    answered_apart = std::max(
        {answered_apart, (place.next(force, at, going, stiffness, stored, 0) - force).norm(),
         (turn.next(torque, turned, turning, stiffness, stored, 0) - torque).norm()});
  }
  CHECK(answered < 1e-6);
  CHECK(answered_apart > 0.1);
}

TEST_CASE("Each contact begins anew, and what is no number leaves the force as it was wanted") {
  PassivityControl control({1, tick, 0, 0.1});
  const Vector3 wanted(0, 0, 1);
  control.rest();
  CHECK(control.next(wanted, {0, 0, -1e-3}, {0, 0, -1}, stiffness, 5e-4, 0) != wanted);
  CHECK(control.generated() > 0);
  control.rest();
  CHECK(control.generated() == 0);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  (void)control.next(wanted, {0, 0, -1e-3}, Vector3::Zero(), stiffness, 5e-4, 0);
  CHECK(control.next(wanted, {0, nan, 0}, {0, 0, 0.1}, stiffness, 5e-4, 0) == wanted);
  CHECK(control.next(wanted, {0, 0, -1e-3}, {nan, 0, 0}, stiffness, nan, 0) == wanted);
  control.reset();
  CHECK(control.generated() == 0);
}

}  // namespace
}  // namespace spm::passivity_control_test
