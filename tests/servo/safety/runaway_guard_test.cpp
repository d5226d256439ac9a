// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/runaway_guard.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "common/base/device_profile.hpp"
#include "servo/devices/wooden/wooden_tracker.hpp"

namespace runaway_guard_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr double tick = 1e-3;  // s
constexpr int steps = 20;      // of the motion, in a tick

/// What holds the device: a mass that moves with it, springs and dampers to where the person wants
/// it, and her own steady push.
struct Hand {
  double mass = 0, stiffness = 0, damping = 0;  // kg, N/m, N s/m
  double push = 0;                              // N
};

/// Where the person wants the hand, m, and how fast, m/s, at a time, s.
using Aim = std::function<std::pair<double, double>(double time)>;

Aim rest(double place) {
  return [place](double) { return std::pair(place, 0.0); };
}

/// From one place to another in a time, as people reach: with the least jerk.
Aim reach(double from, double to, double begin, double time) {
  return [=](double now) {
    const double s = std::clamp((now - begin) / time, 0.0, 1.0);
    const double way = s * s * s * (10 - 15 * s + 6 * s * s);
    const double rate = 30 * s * s * (1 - s) * (1 - s) / time;
    return std::pair(from + (to - from) * way, (to - from) * rate);
  };
}

/// One axis of a device in a loop, on which the commanded force acts with a sign.
struct Axis {
  const DeviceProfile& profile;
  Hand hand;
  double sign = 1;
  int delay = 1;          // ticks
  double friction = 0.1;  // N

  double place = 1e-3, speed = 0, time = 0;  // m, m/s, s

  [[nodiscard]] double reading() const {
    return std::round(place / profile.encoder_step) * profile.encoder_step;
  }
  void move(double force, const Aim& aim) {
    under_way.push_back(force);
    double acting = 0;
    if (static_cast<int>(under_way.size()) > delay) {
      acting = sign * under_way.front();
      under_way.pop_front();
    }
    for (int i = 0; i < steps; ++i) {
      const double dt = tick / steps;
      const auto [wanted, wanted_speed] = aim(time);
      motor += (acting - motor) * std::min(1.0, dt / profile.actuator_lag());
      const double force_now = motor + hand.push - friction * std::tanh(speed / 5e-3) +
                               hand.stiffness * (wanted - place) +
                               hand.damping * (wanted_speed - speed);
      speed += dt * force_now / (profile.moving_mass + hand.mass);
      place += dt * speed;
      time += dt;
    }
  }

  std::deque<double> under_way{};
  double motor = 0;
};

/// The force for a reading and the one before it, N, along x.
using Law = std::function<double(double place, double before, double time)>;

Law wall(double stiffness) {
  return [stiffness](double place, double, double) { return stiffness * std::max(0.0, -place); };
}

struct Run {
  std::optional<int> fired;         ///< the tick
  std::optional<int> half_cap;      ///< the first tick with half of the cap
  double deepest = 0, fastest = 0;  ///< m, m/s, until it fired
};

Run run(Axis axis, const Law& law, const Aim& aim, int ticks) {
  RunawayGuard guard({axis.profile.moving_mass, axis.profile.encoder_step, tick});
  Run done;
  double before = axis.reading();
  for (int i = 0; i < ticks && !done.fired; ++i) {
    const double here = axis.reading();
    if (guard.runs_away({here, 0, 0}, static_cast<std::uint64_t>(i), axis.profile.force_cap)) {
      done.fired = i;
    }
    const double cap = axis.profile.force_cap;
    const double force = done.fired ? 0 : std::clamp(law(here, before, axis.time), -cap, cap);
    before = here;
    if (!done.half_cap && std::abs(force) >= cap / 2) done.half_cap = i;
    guard.sent({force, 0, 0});
    axis.move(force, aim);
    done.deepest = std::max(done.deepest, -axis.place);
    done.fastest = std::max(done.fastest, std::abs(axis.speed));
  }
  return done;
}

void check_fires(const Run& done) {
  REQUIRE(done.half_cap);
  REQUIRE(done.fired);
  CAPTURE(*done.half_cap, *done.fired, done.deepest, done.fastest);
  CHECK(*done.fired - *done.half_cap <= 5);
}

}  // namespace

TEST_CASE("A device that pushes the wrong way is recognised when it has half of its strength") {
  for (const DeviceProfile& profile : device_profiles) {
    for (const double stiffness : {0.6, 0.2}) {
      for (const Hand& hand : {Hand{0, 0, 0, -0.3}, Hand{profile.moving_mass, 0, 1, -0.3},
                               Hand{0.5 * profile.moving_mass, 30, 1, -0.3}}) {
        for (const int delay : {1, 3}) {
          CAPTURE(std::string(profile.name), stiffness, hand.mass, hand.stiffness, delay);
          Axis axis{profile, hand, -1, delay};
          const Run done =
              run(axis, wall(stiffness * profile.stiffness_cap), rest(axis.place), 800);
          check_fires(done);
        }
      }
    }
  }
}

TEST_CASE("A spring that pushes away instead of back is recognised, where the hand leaves it") {
  const DeviceProfile& profile = *find_device_profile("wooden");
  Axis axis{profile, {0, 0, 0, 0.3}, -1};
  axis.place = 0;
  const Law spring = [](double place, double, double) { return -300 * place; };
  check_fires(run(axis, spring, rest(0), 1000));
}

TEST_CASE("No press, tap or reach through a surface is a runaway, however quick") {
  int presses = 0;
  for (const DeviceProfile& profile : device_profiles) {
    for (const double stiffness : {0.6, 0.1}) {
      for (const double depth : {0.003, 0.01, 0.03, 0.1}) {
        for (const double time : {0.03, 0.05, 0.1, 0.2, 0.4}) {
          if (depth / time > 1) continue;
          for (const Hand& hand : {Hand{0.1, 300, 5}, Hand{0.3, 1000, 20}, Hand{1, 1e4, 200}}) {
            for (const double from : {1e-4, 1e-3, 0.02}) {
              CAPTURE(std::string(profile.name), stiffness, depth, time, hand.mass, from);
              Axis axis{profile, hand};
              axis.place = from;
              const Run done = run(axis, wall(stiffness * profile.stiffness_cap),
                                   reach(from, -depth, 0.05, time), 500);
              CHECK_FALSE(done.fired);
              ++presses;
            }
          }
        }
      }
    }
  }
  CHECK(presses > 1000);
}

TEST_CASE("An object that comes or goes under the hand is no runaway") {
  for (const DeviceProfile& profile : device_profiles) {
    for (const double speed : {0.05, 0.3, 1.0}) {
      for (const double way : {0.02, -0.02}) {
        for (const Hand& hand : {Hand{0.1, 300, 5, -0.5}, Hand{0.3, 1000, 20, -2}, Hand{0, 0, 1}}) {
          CAPTURE(std::string(profile.name), speed, way, hand.mass);
          const double stiffness = 0.5 * profile.stiffness_cap;
          const Law moved = [=](double place, double, double time) {
            const double gone = std::clamp((time - 0.2) * speed, 0.0, std::abs(way));
            return stiffness * std::max(0.0, std::copysign(gone, way) - place);
          };
          CHECK_FALSE(run(Axis{profile, hand}, moved, rest(-1e-3), 700).fired);
        }
      }
    }
  }
}

TEST_CASE("Pushes, magnets and thick air of applications are no runaway") {
  const Law pushes = [](double, double, double time) { return time > 0.1 ? 100.0 : 0.0; };
  const Law grows = [](double, double, double time) { return std::exp(20 * (time - 0.2)); };
  const Law magnet = [](double place, double, double) {
    return -2000 * place * std::exp(-std::pow(place / 0.01, 2));
  };
  const Law thick = [](double place, double before, double) {
    return -5 * (place - before) / tick;
  };
  // Pushed the more the farther it is, as a game's wind may be.
  const Law carried = [](double place, double, double) { return 400 * std::max(0.0, place); };
  for (const DeviceProfile& profile : device_profiles) {
    for (const Law* law : {&pushes, &grows, &magnet, &thick, &carried}) {
      for (const Hand& hand : {Hand{0.1, 300, 5}, Hand{0.3, 1000, 20}, Hand{0, 0, 1}}) {
        for (const double to : {0.05, -0.05}) {
          CAPTURE(std::string(profile.name), hand.mass, to);
          Axis axis{profile, hand};
          CHECK_FALSE(run(axis, *law, reach(axis.place, to, 0.1, 0.3), 600).fired);
        }
      }
    }
  }
}

TEST_CASE("Ticks that are left out, and a hand that was away, make no runaway and hide none") {
  const DeviceProfile& profile = *find_device_profile("falcon");
  RunawayGuard guard({profile.moving_mass, profile.encoder_step, tick});
  Axis axis{profile, {0, 0, 0, -0.3}, -1};
  bool fired = false;
  std::uint64_t number = 0;
  for (int i = 0; i < 400 && !fired; ++i) {
    fired = guard.runs_away({axis.reading(), 0, 0}, number, profile.force_cap);
    const double force = std::min(profile.force_cap, 1500 * std::max(0.0, -axis.reading()));
    guard.sent({force, 0, 0});
    // Every 20th tick is late by two.
    for (int late = 0; late < (i % 20 == 0 ? 3 : 1); ++late) {
      axis.move(force, rest(0));
      ++number;
    }
  }
  CHECK(fired);

  guard.forget();
  CHECK_FALSE(guard.runs_away({0.05, 0, 0}, 1000, profile.force_cap));
  guard.sent({8, 0, 0});
  CHECK_FALSE(guard.runs_away({0, 0, 0}, 1001, profile.force_cap));
}

namespace {

/// A board of V2 with the arm of a model: joints that turn by the currents it is sent, each with a
/// wiring of its own.
class Board {
 public:
  Board(const WoodenModel& model, const std::array<double, 3>& wiring)
      : model_(model),
        wiring_(wiring),
        options_(*parse_wooden_options("model=" + std::string(model.name) +
                                       ",home_confirmed=always,signs=" + own_signs(model))),
        tracker_(options_) {
    report_.protocol = WoodenProtocol::v2;
    report_.connection = 1;
    calibration_ = wooden_calibration(options_, WoodenProtocol::v2);
    angles_ = wooden_angles(model_, calibration_, {0, 0, 0});
    home_ = angles_;
  }

  [[nodiscard]] Vector3 read() {
    for (int i = 0; i < 3; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const double turns =
          (angles_[i] - home_[i]) / (2 * M_PI) * model_.body[joint] / model_.capstan[joint];
      report_.counters[joint] = static_cast<std::int16_t>(
          std::lround(calibration_.count_signs[joint] * turns * model_.counts_per_turn[joint]));
    }
    now_ += 1'000'000;
    tracker_.take(report_, now_);
    REQUIRE(tracker_.health(now_) == DeviceHealth::ok);
    return tracker_.state().position;
  }

  /// `drawn`: N m, on each joint, by the hand that holds the arm.
  void write(const Vector3& force, const Vector3& drawn) {
    WoodenCommand command;
    REQUIRE(tracker_.command({force, Vector3::Zero()}, now_, command));
    for (int i = 0; i < 3; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const double gear = model_.capstan[joint] / model_.body[joint];
      const double torque = wiring_[joint] * calibration_.count_signs[joint] *
                            command.currents[joint] * 1e-3 * model_.torque_constant[joint] / gear;
      const double arm = i == 0 ? model_.length[1] : model_.length[joint];
      const double inertia = find_device_profile("wooden")->moving_mass * arm * arm;
      speeds_[i] += tick * (torque + drawn[i]) / inertia;
      angles_[i] += tick * speeds_[i];
    }
  }

  /// Where the tool goes when a joint turns, a unit vector; and the arm at which it does, m.
  [[nodiscard]] std::pair<Vector3, double> along(int joint) const {
    Vector3 turned = angles_;
    turned[joint] += 1e-6;
    const Vector3 way = wooden_to_world *
                        (wooden_position(model_, turned) - wooden_position(model_, angles_)) / 1e-6;
    return {way.normalized(), way.norm()};
  }

 private:
  static std::string own_signs(const WoodenModel& model) {
    return signs_text(model.direction.data(), 3);
  }

  const WoodenModel& model_;
  std::array<double, 3> wiring_;
  WoodenOptions options_;
  WoodenTracker tracker_;
  WoodenReport report_;
  WoodenCalibration calibration_;
  Vector3 angles_ = Vector3::Zero(), home_ = Vector3::Zero(), speeds_ = Vector3::Zero();
  std::int64_t now_ = 1'000'000'000;
};

/// The tick in which the guard saw the board press a wall that stands across a joint's way, after
/// the one in which half of the cap was sent; nothing if it saw nothing.
std::optional<int> ticks_to_see(const WoodenModel& model, int joint, double wiring) {
  std::array<double, 3> wires{1, 1, 1};
  wires[static_cast<std::size_t>(joint)] = wiring;
  Board board(model, wires);
  const DeviceProfile& profile = *find_device_profile("wooden");
  RunawayGuard guard({profile.moving_mass, profile.encoder_step, tick});
  const double cap = wooden_force_cap(model);
  const Vector3 first = board.read();
  const auto [way, arm] = board.along(joint);
  Vector3 drawn = Vector3::Zero();
  drawn[joint] = -0.3 * arm;  // 0.3 N into the wall
  int half = -1;
  for (int i = 0; i < 400; ++i) {
    const Vector3 hand = board.read();
    if (guard.runs_away(hand, static_cast<std::uint64_t>(i), cap)) return half < 0 ? -1 : i - half;
    const double depth = -way.dot(hand - first) - 1e-3;
    const double size = std::min(cap, 800 * std::max(0.0, depth));
    if (half < 0 && size >= cap / 2) half = i;
    guard.sent(size * way);
    board.write(size * way, drawn);
  }
  return std::nullopt;
}

}  // namespace

TEST_CASE("A WoodenHaptics with one motor wired the other way is recognised, whichever it is") {
  for (const WoodenModel& model : wooden_models) {
    for (int joint = 0; joint < 3; ++joint) {
      CAPTURE(std::string(model.name), joint);
      CHECK_FALSE(ticks_to_see(model, joint, 1));
      const auto seen = ticks_to_see(model, joint, -1);
      REQUIRE(seen);
      CHECK(*seen >= 0);
      CHECK(*seen <= 5);
    }
  }
}

}  // namespace runaway_guard_test
