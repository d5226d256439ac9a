// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/laboratory.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "common/contact/stable_stiffness.hpp"
#include "servo/scene/force_choice.hpp"
#include "tests/stability/laboratory/contestants.hpp"
#include "tests/stability/objects/hand_script.hpp"

namespace spm::stability::laboratory_test {
namespace {

/// A hand that presses on a box's top, z = 0, and stays.
StabilityCase pressed_box() {
  StabilityCase tried;
  tried.name = "pressed-box";
  tried.shape = test::moved(test::box(Vector3(0.04, 0.04, 0.02)), Vector3(0, 0, -0.01));
  tried.start = Vector3(1e-3, 2e-3, 1e-3);
  tried.hand = {{Vector3(1e-3, 2e-3, -8e-3), 0.05, 2}};
  tried.delay_ticks = 1;
  tried.seeds = 5;
  return tried;
}

/// A force law that returns what the test sets, and remembers what it was asked.
class Scripted final : public Contestant {
 public:
  explicit Scripted(std::function<Vector3(const Vector3&, const Vector3&)> force)
      : force_(std::move(force)) {}
  void begin(const Vector3& start) override { began = start; }
  ContactForce next(const Vector3& measured, const Vector3& moved) override {
    asked.push_back(measured);
    ContactForce contact;
    contact.force = force_(measured, moved);
    contact.contact = !contact.force.isZero(0);
    contact.depth = contact.force.norm() / 1000;
    return contact;
  }

  Vector3 began = Vector3::Zero();
  std::vector<Vector3> asked;

 private:
  std::function<Vector3(const Vector3&, const Vector3&)> force_;
};

bool same(const Trace& one, const Trace& other) {
  return one.ticks.size() == other.ticks.size() &&
         std::equal(one.ticks.begin(), one.ticks.end(), other.ticks.begin(),
                    [](const TraceTick& a, const TraceTick& b) {
                      return a.position == b.position && a.velocity == b.velocity &&
                             a.measured == b.measured && a.commanded == b.commanded &&
                             a.work == b.work && a.hand_force == b.hand_force;
                    });
}

TEST_CASE("A border is where the first good stiffnesses end, whatever is good beyond") {
  const auto in_two = [](double k) { return (k > 300 && k < 800) || (k > 1200 && k < 5000); };
  const double border = stiffest(in_two, 100, 8000, 0.02);
  CHECK(border < 800);
  CHECK(border > 800 / 1.02);
  const auto but_for_one = [](double k) { return k < 800 && std::abs(k / 400 - 1) > 5e-3; };
  CHECK(stiffest(but_for_one, 100, 3200, 0.02) == Approx(border).epsilon(0.02));
  CHECK(stiffest([](double) { return false; }, 100, 8000, 0.02) == 0);
  CHECK(stiffest([](double) { return true; }, 100, 8000, 0.02) == 8000);
  CHECK(stiffest([](double k) { return k < 100.5; }, 100, 8000, 0.02) == 100);
}

TEST_CASE("A flat wall is good at 0.6 of its border and is not at 1.7, and all seeds agree") {
  const StabilityCase tried = pressed_box();
  for (const char* method : {"exact-penalty", "spm", "proxy", "mesh-proxy", "distance-field"}) {
    CAPTURE(method);
    RunSettings settings;
    const double border = case_border(tried, settings, {method, {}}, 200, 20000, 0.05);
    CAPTURE(border);
    REQUIRE(border > 400);
    REQUIRE(border < 10000);
    settings.stiffness = 0.6 * border;
    const CaseVerdict below = case_verdict(tried, settings, {method, {}});
    CHECK(below.seeds == 5);
    CHECK(below.good());
    settings.stiffness = 1.7 * border;
    const CaseVerdict above = case_verdict(tried, settings, {method, {}});
    CHECK(above.good_seeds == 0);
    CHECK_FALSE(above.worst.reason.empty());
  }
}

TEST_CASE("What is chosen for a device holds a wall and a tap with longer delays too") {
  for (const servo::SimProfile& profile : servo::sim_profiles) {
    const DeviceProfile& device = *find_device_profile(profile.name);
    for (const double delay : {1.0, 2.0, 4.0}) {
      for (const double speed : {0.05, 0.5}) {
        CAPTURE(profile.name, delay, speed);
        StabilityCase tried = pressed_box();
        tried.delay_ticks = delay;
        tried.hand.front().speed = speed;
        RunSettings settings;
        settings.profile = &profile;
        const double share = stiffness_share(device.actuator_lag(), delay, settings.period);
        settings.stiffness = std::min(share * margin_below_border(device), device.stiffness_cap);
        CHECK(case_verdict(tried, settings, {"default", {}}).good());
      }
    }
  }
}

TEST_CASE("The paper's equations hold a flat wall as the exact penalty does") {
  const StabilityCase tried = pressed_box();
  const RunSettings settings;
  const CaseResult paper = run_and_judge(tried, settings, {"paper", {}});
  const CaseResult exact = run_and_judge(tried, settings, {"exact-penalty", {}});
  CHECK(paper.verdict.good);
  CHECK(paper.trace.ticks.back().commanded.z() ==
        Approx(exact.trace.ticks.back().commanded.z()).epsilon(0.02));
}

TEST_CASE("The same seed gives the same trace bit by bit, another seed another") {
  StabilityCase tried = pressed_box();
  tried.noise = 5e-6;
  tried.lost_share = 0.05;
  RunSettings settings;
  for (const char* method : {"spm", "proxy", "exact-penalty"}) {
    CAPTURE(method);
    settings.seed = 7;
    const Trace first = run_and_judge(tried, settings, {method, {}}).trace;
    CHECK(same(first, run_and_judge(tried, settings, {method, {}}).trace));
    settings.seed = 8;
    CHECK_FALSE(same(first, run_and_judge(tried, settings, {method, {}}).trace));
  }
}

TEST_CASE("A carried tool goes where the hand's path goes, whatever pushes it") {
  StabilityCase tried = pressed_box();
  tried.is_carried = true;
  tried.encoder_step = 0;
  tried.delay_ticks = 0;
  tried.seconds = 0.4;
  Scripted law([](const Vector3&, const Vector3&) { return Vector3(0, 0, 3); });
  const Trace trace = run_case(tried, RunSettings{}, law);
  REQUIRE(trace.ticks.size() == 400);
  CHECK(law.began == tried.start);
  const HandScript script(tried, Vector3::Zero());
  for (std::size_t i = 0; i < trace.ticks.size(); ++i) {
    const Vector3 wanted = script.at(static_cast<double>(i) * 1e-3).position;
    REQUIRE(trace.ticks[i].position == wanted);
    REQUIRE(law.asked[i] == wanted);
  }
  // 3 N against 9 mm.
  double work = 0;
  for (const TraceTick& tick : trace.ticks) work += tick.work;
  CHECK(work == Approx(-27e-3));
}

TEST_CASE("A delayed force acts on a carried tool so many ticks later") {
  StabilityCase tried = pressed_box();
  tried.is_carried = true;
  tried.delay_ticks = 3;
  tried.seconds = 0.05;
  int asked = 0;
  Scripted law(
      [&](const Vector3&, const Vector3&) { return Vector3(0, 0, ++asked == 11 ? 2.0 : 0.0); });
  const Trace trace = run_case(tried, RunSettings{}, law);
  for (std::size_t i = 0; i < trace.ticks.size(); ++i) {
    CHECK(trace.ticks[i].hand_force.z() == (i == 13 ? -2.0 : 0.0));
  }
}

TEST_CASE("A tick whose force is lost holds the last one") {
  StabilityCase tried = pressed_box();
  tried.is_carried = true;
  tried.delay_ticks = 0;
  tried.lost_share = 0.3;
  tried.seconds = 1;
  double force = 0;
  Scripted law([&](const Vector3&, const Vector3&) { return Vector3(0, 0, force += 1e-3); });
  const Trace trace = run_case(tried, RunSettings{}, law);
  std::size_t lost = 0;
  double last = 0;
  for (const TraceTick& tick : trace.ticks) {
    const double acts = -tick.hand_force.z();
    if (acts != tick.commanded.z()) {
      ++lost;
      CHECK(acts == last);
    }
    last = acts;
  }
  CHECK(lost > 230);
  CHECK(lost < 370);
}

TEST_CASE("A held tool's reading is rounded to the encoder's step, and no seed begins on one") {
  StabilityCase tried = pressed_box();
  tried.encoder_step = 50e-6;
  tried.seconds = 0.2;
  const auto first = [&](std::uint64_t seed) {
    Scripted law([](const Vector3&, const Vector3&) { return Vector3(0, 0, 0); });
    RunSettings settings;
    settings.seed = seed;
    const Trace trace = run_case(tried, settings, law);
    for (const Vector3& asked : law.asked) {
      const double steps = asked.z() / 50e-6;
      CHECK(std::abs(steps - std::round(steps)) < 1e-6);
    }
    return trace.ticks.front().position;
  };
  CHECK((first(1) - first(2)).norm() > 1e-6);
  CHECK((first(1) - tried.start).cwiseAbs().maxCoeff() <= 25e-6);
}

TEST_CASE("What a surface that moves into a hand puts in is not counted as generated") {
  StabilityCase tried = pressed_box();
  tried.delay_ticks = 0;
  tried.encoder_step = 0;
  // The hand waits 1 mm above the box, which comes up by 5 mm at 20 mm/s.
  tried.hand.clear();
  tried.seconds = 1.5;
  tried.surface = [](double time) {
    return Vector3(0, 0, 5e-3 * std::clamp((time - 0.2) / 0.25, 0.0, 1.0));
  };
  RunSettings settings;
  settings.stiffness = 500;
  for (const char* method : {"exact-penalty", "spm", "proxy", "distance-field"}) {
    CAPTURE(method);
    CaseResult result = run_and_judge(tried, settings, {method, {}});
    CHECK(result.verdict.good);
    double work = 0;
    for (const TraceTick& tick : result.trace.ticks) work += tick.work;
    // The tool was lifted against the hand's springs.
    CHECK(work > 0.3e-3);
    CHECK(result.verdict.findings.generated_j < 0.05 * work);
    for (TraceTick& tick : result.trace.ticks) tick.surface_work = 0;
    const Findings uncounted = find(tried, judged_loop(tried, settings), result.trace);
    CHECK(uncounted.generated_j > 0.95 * work);
  }
}

TEST_CASE("A thin plate holds a hand by a proxy, and loses it by a penalty") {
  StabilityCase tried = pressed_box();
  tried.name = "thin-plate";
  tried.shape = test::moved(test::plate(Vector3(0.04, 0.04, 0.5e-3)), Vector3(0, 0, -0.25e-3));
  tried.max_depth = 1e-3;
  const RunSettings settings;
  CHECK(run_and_judge(tried, settings, {"proxy", {}}).verdict.good);
  CHECK(run_and_judge(tried, settings, {"mesh-proxy", {}}).verdict.good);
  const Verdict penalty = run_and_judge(tried, settings, {"exact-penalty", {}}).verdict;
  CHECK(penalty.bad);
  CHECK(penalty.findings.popped);
}

TEST_CASE("Damping matched to stiffness and delay raises a flat wall's border") {
  const StabilityCase tried = pressed_box();
  const RunSettings settings;
  const auto border = [&](const Contender& contender) {
    return case_border(tried, settings, contender, 200, 20000, 0.05);
  };
  const double plain = border({"proxy", {}});
  CHECK(border({"proxy", "damping"}) > 1.2 * plain);
  CHECK(border({"default", {}}) > 0.95 * plain);
}

TEST_CASE("A hand feels the stiffness that is asked for, a coupling in series included") {
  const StabilityCase tried = pressed_box();
  const RunSettings settings;
  const auto held = [&](const char* stabilization) {
    return run_and_judge(tried, settings, {"proxy", stabilization}).verdict.findings.held_n;
  };
  CHECK(held("coupling") == Approx(held("")).epsilon(0.02));
}

TEST_CASE("An object that is moved takes its proxy along, one that is exchanged forgets it") {
  StabilityCase tried = pressed_box();
  tried.name = "moved-plate";
  tried.shape = test::moved(test::plate(Vector3(0.04, 0.04, 0.5e-3)), Vector3(0, 0, -0.25e-3));
  tried.max_depth = 1e-3;
  tried.hand = {{Vector3(1e-3, 2e-3, -3e-3), 0.05, 2}};
  tried.surface = [](double time) { return Vector3(0, 0, time < 1 ? 0 : 2e-3); };
  const RunSettings settings;
  const Contender proxy{"proxy", {}};
  CHECK_FALSE(run_and_judge(tried, settings, proxy).verdict.findings.popped);
  tried.is_exchanged = true;
  CHECK(run_and_judge(tried, settings, proxy).verdict.findings.popped);
}

TEST_CASE("The default of the laboratory is what the servo serves where nothing is named") {
  const Contender contender = default_contender();
  StabilizationSettings words;
  REQUIRE(parse_stabilization(contender.stabilization, words));
  for (const DeviceProfile& profile : device_profiles) {
    servo::ForceOptions options;
    options.asset = "any.spm.exr";
    options.device = ForceDevice{&profile, profile.stiffness_cap};
    const auto choice = servo::choose_forces(options);
    REQUIRE(choice);
    CHECK(choice->scene.stabilization == in_loop_of(profile, words));
    CHECK(servo::to_string(choice->scene.objects[0].force.method) == contender.method);
    CHECK(choice->scene.objects[0].force.stiffness == stable_stiffness(profile));
  }
}

TEST_CASE("A contender says why it is not asked about a case") {
  StabilityCase tried = pressed_box();
  CHECK(why_not({"spm", "damping"}, tried).empty());
  CHECK_FALSE(why_not({"exact-penalty", "damping"}, tried).empty());
  CHECK_FALSE(why_not({"no-such", {}}, tried).empty());
  tried.effects.friction = {0.5, 0.4, 0};
  CHECK(why_not({"proxy", {}}, tried).empty());
  CHECK_FALSE(why_not({"mesh-proxy", {}}, tried).empty());
  CHECK_FALSE(why_not({"paper", {}}, tried).empty());
  tried.by_the_letter = true;
  tried.effects.friction_force = 0.3;
  CHECK(why_not({"paper", {}}, tried).empty());
}

TEST_CASE("A hand's script goes straight, waits, and stays at its end") {
  StabilityCase tried;
  tried.start = Vector3(0, 0, 0);
  tried.hand = {{Vector3(0.01, 0, 0), 0.1, 0.5}, {Vector3(0.01, 0.02, 0), 0.2, 0}};
  const HandScript script(tried, Vector3(0, 0, 1));
  CHECK(script.at(0.05).position.isApprox(Vector3(0.005, 0, 1)));
  CHECK(script.at(0.05).velocity.isApprox(Vector3(0.1, 0, 0)));
  CHECK(script.at(0.4).position.isApprox(Vector3(0.01, 0, 1)));
  CHECK(script.at(0.4).velocity.isZero());
  CHECK(script.at(0.65).position.isApprox(Vector3(0.01, 0.01, 1)));
  CHECK(script.at(9).position.isApprox(Vector3(0.01, 0.02, 1)));
  CHECK(script.at(9).velocity.isZero());
}

}  // namespace
}  // namespace spm::stability::laboratory_test
