// SPDX-License-Identifier: Apache-2.0
// Several applications beside the real loop: what one of them made or took is not another's.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "servo/app/app_scene.hpp"
#include "servo/shared/shared_words.hpp"
#include "tests/servo/support/loop_beside.hpp"

namespace app_ownership_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

namespace {

spm_client_command_counts counts_of(const Connected& application) {
  auto counts = sized<spm_client_command_counts>();
  static_cast<void>(spm_client_refusals(application.client, &counts));
  return counts;
}

/// Waits until the loop has come to all that an application sent; how many of it were refused.
std::uint64_t refused(const Connected& application) {
  REQUIRE(eventually([&] {
    const spm_client_command_counts counts = counts_of(application);
    return counts.taken == counts.sent;
  }));
  // The loop refuses in the tick in which it takes.
  auto tick = sized<spm_client_tick>();
  static_cast<void>(spm_client_read_tick(application.client, &tick));
  const std::uint64_t taken_in = tick.tick;
  REQUIRE(eventually([&] {
    static_cast<void>(spm_client_read_tick(application.client, &tick));
    return tick.tick > taken_in + 1;
  }));
  return counts_of(application).refused;
}

std::string reason(const Connected& application) {
  return spm_client_refusal(counts_of(application).last_refusal);
}

}  // namespace

TEST_CASE("A clutch that an application held is let go when the application dies") {
  LoopBeside beside;
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  auto other = std::make_unique<Connected>(beside.path());
  REQUIRE(spm_client_set_clutch(other->client, 0, 1) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] { return beside.device().cause == SPM_CLIENT_OFF_CLUTCHED; }));
  other.reset();
  CHECK(beside.comes_to(1));
  CHECK(beside.device().cause == SPM_CLIENT_FORCE_ON);
}

TEST_CASE("A clutch that one application holds is refused to another, with the reason") {
  const LoopBeside beside;
  const Connected other(beside.path());
  REQUIRE(spm_client_set_clutch(beside.here->client, 0, 1) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] { return beside.device().cause == SPM_CLIENT_OFF_CLUTCHED; }));
  const int on = GENERATE(0, 1);
  REQUIRE(spm_client_set_clutch(other.client, 0, on) == SPM_CLIENT_OK);
  CHECK(refused(other) == 1);
  CHECK(contains(reason(other), "another application holds the clutch"));
  CHECK(beside.device().cause == SPM_CLIENT_OFF_CLUTCHED);
  REQUIRE(spm_client_set_clutch(beside.here->client, 0, 0) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] { return beside.device().cause == SPM_CLIENT_FORCE_ON; }));
  REQUIRE(spm_client_set_clutch(other.client, 0, 1) == SPM_CLIENT_OK);
  CHECK(eventually([&] { return beside.device().cause == SPM_CLIENT_OFF_CLUTCHED; }));
  CHECK(refused(other) == 1);
}

TEST_CASE("Of sixteen applications that fight for one clutch, one has it, and keeps it") {
  LoopBeside beside;
  std::vector<std::unique_ptr<Connected>> all;
  all.push_back(std::move(beside.here));
  while (all.size() < SPM_MAX_APPLICATIONS)
    all.push_back(std::make_unique<Connected>(beside.path()));
  beside.here = std::make_unique<Connected>(beside.path());
  REQUIRE(beside.here->code == SPM_CLIENT_REFUSED);  // there is no place for a seventeenth
  const auto cause = [&] {
    auto read = sized<spm_client_device>();
    static_cast<void>(spm_client_read_device(all.front()->client, 0, &read));
    return read.cause;
  };
  std::vector<std::uint64_t> before(all.size(), 0);
  /// Which of them were not refused since the last call.
  const auto winners = [&] {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::uint64_t now = refused(*all[i]);
      if (now == before[i]) found.push_back(i);
      before[i] = now;
    }
    return found;
  };
  for (int round = 0; round < 10; ++round) {
    for (const auto& each : all) REQUIRE(spm_client_set_clutch(each->client, 0, 1) == 0);
    const std::vector<std::size_t> taken = winners();
    REQUIRE(taken.size() == 1);
    for (const auto& each : all) {
      if (each != all[taken[0]]) REQUIRE(spm_client_set_clutch(each->client, 0, 0) == 0);
    }
    REQUIRE(winners() == taken);
    REQUIRE(cause() == SPM_CLIENT_OFF_CLUTCHED);
    REQUIRE(spm_client_set_clutch(all[taken[0]]->client, 0, 0) == 0);
    REQUIRE(eventually([&] { return cause() == SPM_CLIENT_FORCE_ON; }));
  }
}

namespace {

spm_client_material stiff(double stiffness) {
  auto material = sized<spm_client_material>();
  material.fields = SPM_CLIENT_STIFFNESS;
  material.stiffness = stiffness;
  return material;
}

/// Asks for one object to be moved, changed and removed; how many of the three were refused.
std::uint64_t meddle(const Connected& application, std::uint64_t object) {
  const std::uint64_t before = refused(application);
  const spm_client_pose elsewhere = raised(0.5);
  const spm_client_material soft = stiff(1);
  REQUIRE(spm_client_move_object(application.client, object, &elsewhere) == SPM_CLIENT_OK);
  REQUIRE(spm_client_set_material(application.client, object, &soft) == SPM_CLIENT_OK);
  REQUIRE(spm_client_remove_object(application.client, object) == SPM_CLIENT_OK);
  return refused(application) - before;
}

}  // namespace

TEST_CASE("What an application added is moved, changed and removed by nobody else") {
  const LoopBeside beside;
  const Connected other(beside.path());
  const spm_client_pose up = raised(2 * above);
  const spm_client_material own = stiff(500);
  std::uint64_t added = 0;
  REQUIRE(spm_client_add_object(beside.here->client, 0, &up, 1, &own, &added) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0.5));
  CHECK(meddle(other, added) == 3);
  CHECK(contains(reason(other), "belongs to another application"));
  CHECK(beside.comes_to(0.5));
  CHECK(refused(*beside.here) == 0);
}

TEST_CASE("An object of the scene belongs to the first that moves it, until that one leaves") {
  LoopBeside beside;
  const Connected other(beside.path());
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  CHECK(meddle(other, 0) == 3);
  CHECK(beside.comes_to(1));
  beside.leave();
  const spm_client_material soft = stiff(500);
  REQUIRE(eventually([&] {
    const std::uint64_t before = refused(other);
    REQUIRE(spm_client_set_material(other.client, 0, &soft) == SPM_CLIENT_OK);
    return refused(other) == before;
  }));
  beside.here = std::make_unique<Connected>(beside.path());
  CHECK(beside.comes_to(0.5));
  CHECK(meddle(*beside.here, 0) == 3);
}

TEST_CASE("An object that the scene holds still belongs to nobody who only asked to move it") {
  const LoopBeside beside(false);
  const Connected other(beside.path());
  const spm_client_pose up = raised(2 * above);
  const spm_client_material soft = stiff(500);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  CHECK(refused(*beside.here) == 1);
  REQUIRE(spm_client_set_material(other.client, 0, &soft) == SPM_CLIENT_OK);
  CHECK(refused(other) == 0);
}

TEST_CASE("A supervisor changes what is another's without taking it, and takes a clutch") {
  const LoopBeside beside;
  const Connected supervisor(beside.path(), 20000, SPM_CLIENT_SUPERVISOR);
  REQUIRE(supervisor.message.empty());
  const spm_client_pose up = raised(2 * above);
  const spm_client_material soft = stiff(500);
  std::uint64_t added = 0;
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  REQUIRE(spm_client_set_material(supervisor.client, 0, &soft) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0.5));
  REQUIRE(spm_client_add_object(beside.here->client, 0, &up, 1, &soft, &added) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  REQUIRE(spm_client_remove_object(supervisor.client, added) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0.5));
  REQUIRE(spm_client_set_clutch(beside.here->client, 0, 1) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] { return beside.device().cause == SPM_CLIENT_OFF_CLUTCHED; }));
  REQUIRE(spm_client_set_clutch(supervisor.client, 0, 0) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0.5));
  CHECK(refused(supervisor) == 0);
  // The object is still the application's.
  const spm_client_pose down = raised(0);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &down) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0));
  CHECK(refused(*beside.here) == 0);
}

TEST_CASE("An application lowers the force cap while it is there, and never raises the daemon's") {
  LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  const double own = beside.device().force_cap;
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  auto careful = std::make_unique<Connected>(beside.path());
  const Connected bold(beside.path());
  REQUIRE(spm_client_set_force_cap(careful->client, 0, 0.4) == SPM_CLIENT_OK);
  REQUIRE(spm_client_set_force_cap(bold.client, 0, 1000) == SPM_CLIENT_OK);
  CHECK(eventually([&] { return beside.device().force_cap == 0.4; }));
  CHECK(beside.comes_to(0.4));
  CHECK(beside.device().cause == SPM_CLIENT_FORCE_ON);
  careful.reset();
  CHECK(beside.comes_to(1));
  CHECK(eventually([&] { return beside.device().force_cap == std::min(own, 1000.0); }));
}

TEST_CASE("The place where the surface holds the tool is told") {
  const LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  CHECK(beside.device().proxy[2] == beside.device().position[2]);
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  REQUIRE(eventually([&] { return beside.object(0).position[2] == 2 * above; }));
  REQUIRE(eventually([&] { return beside.device().proxy[2] == Approx(box_half + 2 * above); }));
  CHECK(beside.device().proxy[0] == Approx(0).margin(1e-9));
  CHECK(beside.device().position[2] == Approx(box_half + above));
}

TEST_CASE("Whatever numbers a client writes, the objects stay, and each is refused by its reason") {
  RawRing hostile(99);
  const LoopBeside beside;
  beside.attach(hostile);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  std::uint64_t sent = 0;
  for (const double value : {nan, infinity, -infinity, 1e9, -1e9}) {
    for (const std::uint32_t kind : {SPM_COMMAND_MOVE, SPM_COMMAND_ADD, SPM_COMMAND_MATERIAL}) {
      spm_shared_command command = move_command(kind == SPM_COMMAND_ADD ? 7 : 0, value);
      command.kind = kind;
      command.scale = 1;
      command.fields = SPM_MATERIAL_ALL;
      command.stiffness = command.damping = value;
      hostile.write(command);
      ++sent;
      REQUIRE(eventually([&] { return load_acquire(hostile.ring().refused) == sent; }));
      const auto why = static_cast<Refusal>(load_relaxed(hostile.ring().last_refusal));
      CHECK(why == (std::isfinite(value) ? Refusal::out_of_range : Refusal::not_finite));
    }
  }
  CHECK(beside.object(0).position[0] == 0);
  CHECK(beside.device().force[2] == 0);
  CHECK(beside.device().cause == SPM_CLIENT_FORCE_ON);
}

}  // namespace app_ownership_test
