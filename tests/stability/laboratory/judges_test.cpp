// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/judges.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>

namespace spm::stability::judges_test {
namespace {

constexpr double period = 1e-3;  // s

/// A trace of so many seconds; `fill` sets each tick from its time.
Trace trace_of(double seconds, const std::function<void(double, TraceTick&)>& fill) {
  Trace trace;
  trace.period = period;
  const auto count = static_cast<std::size_t>(std::lround(seconds / period));
  for (std::size_t i = 0; i < count; ++i) {
    TraceTick tick;
    tick.time = static_cast<double>(i) * period;
    fill(tick.time, tick);
    trace.ticks.push_back(tick);
  }
  return trace;
}

/// A tool that is held 1 mm below a wall at z = 0 by a hand that wants it 5 mm below.
void hold(TraceTick& tick) {
  tick.contact = true;
  tick.target = Vector3(0, 0, -5e-3);
  tick.position = Vector3(0, 0, tick.time < 0.5 ? 0 : -1e-3);
  tick.commanded = Vector3(0, 0, 0.5);
}

double sine(double frequency, double time) {
  return std::sin(2 * std::numbers::pi * frequency * time);
}

/// A wall of 1000 N/m at a hand of 125 N/m.
JudgedLoop soft_loop() {
  JudgedLoop loop;
  loop.hand_stiffness = 125;
  return loop;
}

TEST_CASE("A quiet hold is good and has no ripple") {
  const Trace trace = trace_of(2, [](double, TraceTick& tick) { hold(tick); });
  const Verdict verdict = judge(StabilityCase{}, soft_loop(), trace);
  CHECK(verdict.good);
  CHECK_FALSE(verdict.bad);
  CHECK(verdict.reason.empty());
  CHECK(verdict.findings.ripple_n < 1e-12);
  CHECK(verdict.findings.ripple_m < 1e-12);
  CHECK(verdict.findings.penetration_m == Approx(1e-3));
  CHECK(verdict.findings.settled_s == Approx(0.5));
}

TEST_CASE(
    "A sine's ripple is its amplitude over the root of two, whatever steady drift it rides on") {
  // 50 Hz: whole periods in the moving mean's window but for its middle tick.
  const Trace trace = trace_of(2, [](double time, TraceTick& tick) {
    hold(tick);
    tick.commanded.z() += 0.2 * sine(50, time) + 0.5 * time;
    tick.position.x() = 30e-6 * sine(50, time) + 1e-3 * time;
  });
  const Findings found = find(StabilityCase{}, soft_loop(), trace);
  CHECK(found.ripple_n == Approx(0.2 / std::numbers::sqrt2).epsilon(0.02));
  CHECK(found.ripple_m == Approx(60e-6).epsilon(0.02));
}

TEST_CASE("Ripple below 0.03 N is good, above 0.1 N bad, and between neither") {
  const auto verdict_at = [](double rms) {
    return judge(StabilityCase{}, soft_loop(), trace_of(2, [&](double time, TraceTick& tick) {
                   hold(tick);
                   tick.commanded.z() += std::numbers::sqrt2 * rms * sine(50, time);
                 }));
  };
  CHECK(verdict_at(0.028).good);
  CHECK_FALSE(verdict_at(0.033).good);
  CHECK_FALSE(verdict_at(0.033).bad);
  CHECK_FALSE(verdict_at(0.09).bad);
  CHECK(verdict_at(0.11).bad);
  CHECK(verdict_at(0.11).reason.find("ripple") != std::string::npos);
}

TEST_CASE("A tool may swing by three encoder steps, or by 100 um where these are less") {
  const auto is_bad = [](double swing, double encoder_step) {
    JudgedLoop loop = soft_loop();
    loop.encoder_step = encoder_step;
    return judge(StabilityCase{}, loop,
                 trace_of(2,
                          [&](double time, TraceTick& tick) {
                            hold(tick);
                            tick.position.y() = swing / 2 * sine(50, time);
                          }))
        .bad;
  };
  CHECK_FALSE(is_bad(95e-6, 0));
  CHECK(is_bad(105e-6, 0));
  CHECK_FALSE(is_bad(180e-6, 64e-6));
  CHECK(is_bad(205e-6, 64e-6));
}

TEST_CASE("A case that does not judge ripple takes any") {
  StabilityCase tried;
  tried.judged.ripple = false;
  const Trace trace = trace_of(2, [](double time, TraceTick& tick) {
    hold(tick);
    tick.commanded.z() += sine(50, time);
  });
  CHECK(judge(tried, soft_loop(), trace).good);
}

TEST_CASE("The envelope ratio of a growing oscillation is above 1, of a decaying one below") {
  const auto ratio = [](double rate) {
    return envelope_ratio(trace_of(2, [&](double time, TraceTick& tick) {
      tick.velocity.z() = std::exp(rate * time) * sine(100, time + 1.25e-3);
    }));
  };
  // For a growing motion the peaks lie at the quarters' ends, 1 s apart; energy grows at twice the
  // rate.
  CHECK(ratio(1) == Approx(std::exp(2.0)).epsilon(0.05));
  // For a decaying motion they lie at the quarters' starts, also 1 s apart.
  CHECK(ratio(-1) == Approx(std::exp(-2.0)).epsilon(0.05));
  CHECK(ratio(0) == Approx(1).epsilon(0.01));
  CHECK(envelope_ratio(trace_of(1, [](double, TraceTick&) {})) == 0);
}

TEST_CASE("A surface that no longer holds what the hand presses with has popped") {
  const auto verdict_of = [](double held, double pressed) {
    StabilityCase tried;
    tried.pressed = pressed;
    return judge(tried, soft_loop(), trace_of(2, [&](double, TraceTick& tick) {
                   hold(tick);
                   tick.commanded.z() = held;
                 }));
  };
  // 1000 and 125 N/m in series: 111 N/m.
  const Verdict held = verdict_of(0.36, 10e-3);
  CHECK(held.good);
  CHECK(held.findings.pressed_n == Approx(1000 * 125 / 1125.0 * 10e-3));
  CHECK(verdict_of(0.31, 10e-3).findings.popped);
  CHECK(verdict_of(0.31, 10e-3).bad);
  CHECK(verdict_of(-0.5, 10e-3).bad);
  // A hand that no longer presses is held by nothing.
  CHECK(verdict_of(0, -1e-3).good);
}

TEST_CASE("Where the hand presses is told from where the tool first touched") {
  const auto found_at = [](double contact_from) {
    return find(StabilityCase{}, soft_loop(), trace_of(2, [&](double time, TraceTick& tick) {
                  tick.target = Vector3(0, 0, -9e-3);
                  tick.position = Vector3(0, 0, time < 1 ? 0 : -9e-3);
                  tick.contact = time >= contact_from && time < 1;
                }));
  };
  const Findings popped = found_at(0.5);
  CHECK(popped.popped);
  CHECK(popped.pressed_n == Approx(1.0));
  // One that never felt the surface has fallen through as well.
  CHECK(found_at(5).popped);
}

TEST_CASE("A device's friction may carry what a light hand presses with") {
  JudgedLoop loop = soft_loop();
  const Trace trace = trace_of(2, [](double, TraceTick& tick) {
    hold(tick);
    tick.commanded.z() = 0.1;
  });
  // The hand presses with 0.556 N.
  CHECK(find(StabilityCase{}, loop, trace).popped);
  loop.friction = 0.3;
  CHECK_FALSE(find(StabilityCase{}, loop, trace).popped);
}

TEST_CASE("The energy generated is the largest sum of work over time") {
  const Trace trace = trace_of(2, [](double time, TraceTick& tick) {
    hold(tick);
    tick.work = time < 0.5 ? -1e-6 : time < 1.5 ? 2e-6 : -3e-6;
  });
  // -0.5 mJ, then 2 mJ more.
  CHECK(find(StabilityCase{}, soft_loop(), trace).generated_j == Approx(1.5e-3));
  const Trace passive = trace_of(2, [](double, TraceTick& tick) { tick.work = -1e-6; });
  CHECK(find(StabilityCase{}, soft_loop(), passive).generated_j == 0);
}

TEST_CASE("What a moving surface puts in is not generated") {
  const auto generated = [](double surface_work) {
    return find(StabilityCase{}, soft_loop(),
                trace_of(1,
                         [&](double, TraceTick& tick) {
                           tick.work = 2e-6;
                           tick.surface_work = surface_work;
                         }))
        .generated_j;
  };
  CHECK(generated(0) == Approx(2e-3));
  CHECK(generated(2e-6) == Approx(0).margin(1e-12));
  CHECK(generated(1.5e-6) == Approx(0.5e-3));
}

TEST_CASE("The energy's bound is that of the tick's leak and of the encoder's step") {
  JudgedLoop loop;
  loop.stiffness = 2000;
  loop.delay = 2;
  loop.lag = 0.5e-3;
  loop.encoder_step = 50e-6;
  loop.force_cap = 3;
  const Trace trace = trace_of(1, [](double time, TraceTick& tick) {
    tick.contact = time > 0.5;
    tick.velocity = Vector3(0, 0, time > 0.5 ? 0.1 : 7);
    tick.commanded = Vector3(0, 4, 0);
  });
  // 2 (2000 N/m (1/2 + 2 + 1/2) (0.1 mm)^2 + 3 N 50 um); free motion does not count.
  CHECK(find(StabilityCase{}, loop, trace).generated_bound_j ==
        Approx(2 * (2000 * 3 * 1e-8 + 3 * 50e-6)));
}

TEST_CASE("Energy beyond the bound is told, and decides for a tool that is carried") {
  const auto verdict_of = [](double work, bool is_carried) {
    StabilityCase tried;
    tried.is_carried = is_carried;
    JudgedLoop loop = soft_loop();
    loop.encoder_step = 1e-3;
    // The bound is 2 * 0.5 N * 1 mm: 1 mJ.
    return judge(tried, loop, trace_of(1, [&](double, TraceTick& tick) {
                   hold(tick);
                   tick.position.z() = 0;
                   tick.target.z() = 0;
                   tick.work = work / 1000;
                 }));
  };
  CHECK(verdict_of(0.9e-3, false).within_energy);
  CHECK_FALSE(verdict_of(1.1e-3, false).within_energy);
  CHECK(verdict_of(1.1e-3, false).good);
  CHECK(verdict_of(0.9e-3, true).good);
  CHECK_FALSE(verdict_of(1.1e-3, true).good);
  CHECK_FALSE(verdict_of(1.1e-3, true).bad);
  CHECK(verdict_of(2.1e-3, true).bad);
}

TEST_CASE("A tool that creeps on under a resting hand never settles") {
  const auto verdict_of = [](double target_speed) {
    return judge(StabilityCase{}, soft_loop(), trace_of(2, [&](double time, TraceTick& tick) {
                   hold(tick);
                   tick.position.x() = 1e-3 * time;
                   tick.target.x() = target_speed * time;
                 }));
  };
  CHECK_FALSE(verdict_of(0).good);
  CHECK_FALSE(verdict_of(0).bad);
  CHECK(std::isinf(verdict_of(0).findings.settled_s));
  // It follows a hand that moves.
  CHECK(verdict_of(1e-3).good);
}

TEST_CASE("Deeper than a case allows is bad") {
  StabilityCase tried;
  tried.judged.longest_penetration = 0.9e-3;
  const Trace trace = trace_of(2, [](double, TraceTick& tick) { hold(tick); });
  CHECK(judge(tried, soft_loop(), trace).bad);
  tried.judged.longest_penetration = 1.1e-3;
  CHECK(judge(tried, soft_loop(), trace).good);
}

}  // namespace
}  // namespace spm::stability::judges_test
