// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/replay.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <fstream>

#include "common/base/random.hpp"
#include "common/query/query.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace replay_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr double half = 0.02;

/// The assets of a scene of one object.
std::array<const AssetView*, 1> one(const AssetTables& tables) { return {&tables.view()}; }

std::vector<TrajectorySample> random_trajectory(std::uint64_t seed, std::size_t rows) {
  Random random(seed);
  std::vector<TrajectorySample> trajectory(rows);
  for (TrajectorySample& row : trajectory) {
    for (int axis = 0; axis < 3; ++axis) {
      row.position[axis] = random.between(-half - 2e-3, half + 2e-3);
    }
  }
  return trajectory;
}

}  // namespace

TEST_CASE("A replay answers every row with the force law: stiffness times depth") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  for (const Method method : {Method::spm, Method::paper}) {
    for (const double stiffness : {0.0, 500.0, 3000.0}) {
      ReplayOptions options;
      ForceSettings& force = options.scene.objects.front().force;
      force.method = method;
      force.stiffness = stiffness;
      const auto trajectory = random_trajectory(5, 3000);
      const ReplayResult result = replay(one(tables), trajectory, options);
      REQUIRE(result.contacts.size() == trajectory.size());
      REQUIRE(result.busy_ns.size() == trajectory.size());
      std::uint64_t touching = 0;
      for (std::size_t i = 0; i < trajectory.size(); ++i) {
        const ContactForce& contact = result.contacts[i];
        touching += contact.contact ? 1 : 0;
        REQUIRE(contact.force.norm() == Approx(stiffness * contact.depth).epsilon(1e-9));
        const ContactForce again = contact_force(tables.view(), force, trajectory[i].position);
        REQUIRE(contact.force == again.force);
      }
      REQUIRE(touching > 1000);
      REQUIRE(contact_ticks(result) == touching);
    }
  }
}

TEST_CASE("The depth is that below the nearest face of a box") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  std::vector<TrajectorySample> trajectory(3);
  trajectory[0].position = {half - 0.5e-3, 0.003, 0.001};
  trajectory[1].position = {0, -(half - 1.5e-3), 0.002};
  trajectory[2].position = {0, 0, half + 1e-4};
  for (const Method method : {Method::spm, Method::paper}) {
    ReplayOptions options;
    options.scene.objects.front().force.method = method;
    const auto contacts = replay(one(tables), trajectory, options).contacts;
    REQUIRE(contacts[0].depth == Approx(0.5e-3).epsilon(1e-3));
    REQUIRE(contacts[0].force.x() == Approx(0.5).epsilon(1e-3));
    REQUIRE(contacts[1].depth == Approx(1.5e-3).epsilon(1e-3));
    REQUIRE(contacts[1].force.y() == Approx(-1.5).epsilon(1e-3));
    REQUIRE_FALSE(contacts[2].contact);
    REQUIRE(contacts[2].force == Vector3::Zero());
  }
}

TEST_CASE("A replay has the stabilizers of its scene, and none where the scene has none") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  std::vector<TrajectorySample> pressed(60);
  for (std::size_t i = 0; i < pressed.size(); ++i) {
    pressed[i].position = {0.001, 0.002, half - 2e-5 * static_cast<double>(i)};
  }
  ReplayOptions options;
  const ReplayResult bare = replay(one(tables), pressed, options);
  options.scene.stabilization = recommended_stabilization;
  const ReplayResult stabilized = replay(one(tables), pressed, options);
  options.scene.stabilization.coupling = 500;
  const ReplayResult coupled = replay(one(tables), pressed, options);
  const double depth = bare.contacts.back().depth;
  CHECK(bare.contacts.back().force.z() == Approx(1000 * depth));
  // At 20 mm/s.
  const double damping = matched_damping(recommended_damping_share, 1000, 1, 1e-3);
  CHECK(stabilized.contacts.back().force.z() == Approx(1000 * depth + damping * 0.02));
  CHECK(coupled.contacts.back().force.z() == Approx(400 * depth + 0.4 * damping * 0.02));
}

TEST_CASE("Force steps are the differences of consecutive forces") {
  ReplayResult result;
  for (const double force : {0.0, 1.0, 1.0, -2.0}) {
    ContactForce contact;
    contact.force.x() = force;
    result.contacts.push_back(contact);
  }
  const Summary steps = force_steps(result);
  REQUIRE(steps.max == 3.0);
  REQUIRE(steps.p50 == 1.0);
  REQUIRE(steps.mean == Approx(4.0 / 3));
}

TEST_CASE("A replay of nothing has no rows and no times") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const ReplayResult result = replay(one(tables), {}, {});
  REQUIRE(contact_ticks(result) == 0);
  REQUIRE(us_per_tick(result).max == 0);
  REQUIRE(force_steps(result).max == 0);
}

TEST_CASE("In real time each row is answered too, with the same forces") {
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const auto trajectory = random_trajectory(6, 100);
  ReplayOptions options;
  const ReplayResult fast = replay(one(tables), trajectory, options);
  options.pace = Pace::realtime;
  options.rate_hz = 4000;
  const ReplayResult paced = replay(one(tables), trajectory, options);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    REQUIRE(paced.contacts[i].force == fast.contacts[i].force);
  }
}

TEST_CASE("The table of a replay has one row a tick") {
  const test::TemporaryFolder folder;
  const Asset asset = test::box_asset(2 * half);
  const AssetTables tables = tables_of(asset);
  const auto trajectory = random_trajectory(7, 777);
  const ReplayResult result = replay(one(tables), trajectory, {});
  REQUIRE(write_replay(folder.file("out.csv"), trajectory, result, 2000));
  std::ifstream file(folder.file("out.csv"));
  std::string line, last;
  std::size_t lines = 0;
  while (std::getline(file, line)) {
    ++lines;
    last = line;
  }
  REQUIRE(lines == 778);
  REQUIRE(last.substr(0, 6) == "0.388,");
}

TEST_CASE("Rows of a recording are compared up to the first that is of another scene") {
  Recording recording;
  recording.header.devices.resize(2);
  const auto add = [&](std::uint64_t tick, std::uint16_t device, int flags) {
    RecordingRow row;
    row.tick = tick;
    row.device = device;
    row.flags = static_cast<std::uint16_t>(flags);
    recording.rows.push_back(row);
  };
  for (std::uint64_t tick = 100; tick < 110; ++tick) {
    add(tick, 0, (tick >= 104 ? recorded_touched : 0) | (tick == 107 ? recorded_edited : 0));
    add(tick, 1, tick == 109 ? recorded_edited : recorded_contact);
  }
  const RecordedTicks moved = ticks_of(recording, 0);
  CHECK(moved.change == SceneChange::application);
  CHECK(moved.changed_tick == 104);
  CHECK(moved.comparable == 4);
  CHECK(moved.wanted.size() == 10);
  const RecordedTicks edited = ticks_of(recording, 1);
  CHECK(edited.change == SceneChange::edit);
  CHECK(edited.changed_tick == 109);
  CHECK(edited.comparable == 9);
  for (RecordingRow& row : recording.rows) row.flags = recorded_forgot;
  const RecordedTicks same = ticks_of(recording, 0);
  CHECK(same.change == SceneChange::none);
  CHECK(same.comparable == 10);
}

TEST_CASE("A replay has caught up where its forces stay equal for longer than any memory") {
  ReplayResult result;
  result.contacts.resize(9000);
  std::vector<Wrench> wanted(9000, Wrench{{0, 1, 0}});
  for (std::size_t row = 0; row < wanted.size(); ++row) {
    ContactForce& contact = result.contacts[row];
    contact.contact = row % 2 == 0;
    contact.force = wanted[row].force = contact.contact ? Vector3(0, 1, 0) : Vector3(0, 0, 0);
  }
  CHECK(caught_up(result, wanted) == 0);
  wanted[10].force.x() = 1e-17;
  wanted[1500].force.x() = 1e-17;
  CHECK(caught_up(result, wanted) == 1501);
  for (std::size_t row = 0; row < wanted.size(); row += 2000) wanted[row].force.x() = 1e-17;
  CHECK(caught_up(result, wanted) == wanted.size());
  // Where nothing was touched, equal forces say nothing.
  for (ContactForce& contact : result.contacts) contact = {};
  CHECK(caught_up(result, std::vector<Wrench>(9000)) == 9000);
}

TEST_CASE("Rows of a recording are compared from the first whose state before it is known") {
  Recording recording;
  recording.header.devices.resize(1);
  RecordingRow row;
  row.flags = recorded_contact;
  for (; row.tick < 50; ++row.tick) recording.rows.push_back(row);
  CHECK(ticks_of(recording, 0).settled == 50);
  // In a tick without force the hand keeps its side, which is not known.
  recording.rows[20].cause = 1;
  CHECK(ticks_of(recording, 0).settled == 50);
  recording.rows[5].flags |= recorded_forgot;
  CHECK(ticks_of(recording, 0).settled == 5);
  for (RecordingRow& free : recording.rows) free.flags = free.cause = 0;
  for (; row.tick < 4000; ++row.tick) recording.rows.push_back(recording.rows.front());
  CHECK(ticks_of(recording, 0).settled == 3000);
}

TEST_CASE("A tick without force whose law kept its state is asked again, one that is off is not") {
  Recording recording;
  recording.header.devices.resize(1);
  for (RecordingRow row; row.tick < 3; ++row.tick) {
    row.cause = row.tick > 0 ? 1 : 0;
    row.flags = row.tick == 1 ? recorded_kept : 0;
    row.orientation = {0.6, 0, 0.8, 0};
    row.sent_torque = row.wanted_torque = {0, 0.1, 0};
    row.level = 3;
    recording.rows.push_back(row);
  }
  const RecordedTicks ticks = ticks_of(recording, 0);
  CHECK_FALSE(ticks.marks[0].off);
  CHECK_FALSE(ticks.marks[1].off);
  CHECK(ticks.marks[2].off);
  REQUIRE(ticks.marks[0].sent);
  CHECK(ticks.marks[0].sent->torque == Vector3(0, 0.1, 0));
  CHECK_FALSE(ticks.marks[1].sent);
  CHECK(ticks.marks[0].effort.level == 3);
  CHECK(ticks.wanted[0].torque == Vector3(0, 0.1, 0));
  CHECK(ticks.trajectory[0].pose().orientation.coeffs() ==
        Eigen::Quaterniond(0.6, 0, 0.8, 0).coeffs());
}

TEST_CASE("Forces are compared in the rows that are asked for, and in no other") {
  ReplayResult result;
  result.contacts.resize(4);
  std::vector<Wrench> wanted(4);
  wanted[2].force = {0, 0.5, 0};
  wanted[3].force = {0, 0, 2};
  CHECK(difference(result, std::span(wanted).first(2)).ticks == 0);
  const ForceDifference two = difference(result, wanted);
  CHECK(two.ticks == 2);
  CHECK(two.first_row == 2);
  CHECK(two.largest == 2);
}

}  // namespace replay_test
