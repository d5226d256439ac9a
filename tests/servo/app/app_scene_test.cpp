// SPDX-License-Identifier: Apache-2.0
// An application beside the real loop: what it asks for is felt by the hand.
#include "servo/app/app_scene.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "servo/shared/shared_words.hpp"
#include "tests/servo/support/loop_beside.hpp"

namespace app_scene_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

TEST_CASE("An object that an application moves into the hand is felt, and told what it got") {
  const LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().connected == 1; }));
  CHECK(beside.device().contact == 0);
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  const spm_client_object box = beside.object(0);
  CHECK(box.position[2] == Approx(2 * above));
  CHECK(box.force[2] == Approx(-1).epsilon(0.05));
  CHECK(box.driven == 1);
  CHECK(box.contact == 1);
}

TEST_CASE("An object that the scene holds still stays, and the application is told why") {
  // Without the library, which would not send it.
  RawRing ring(77);
  const LoopBeside beside(false);
  beside.attach(ring);
  ring.write(move_command(0, 0.01));
  REQUIRE(eventually([&] { return servo::load_acquire(ring.ring().refused) == 1; }));
  CHECK(contains(spm_client_refusal(static_cast<std::uint32_t>(ring.ring().last_refusal)),
                 "movable = true"));
  CHECK(beside.object(0).position[0] == 0);
}

TEST_CASE("Records say from which tick on an application has touched the scene") {
  LoopBeside beside;
  REQUIRE(eventually([&] { return beside.device().tick > 20; }));
  // Neither watching nor a refused command touches the scene.
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_remove_object(beside.here->client, 0) == SPM_CLIENT_OK);
  REQUIRE_FALSE(beside.refusal().empty());
  for (const TickRecord& record : beside.records()) REQUIRE_FALSE(record.touched);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  const std::vector<TickRecord> records = beside.records();
  const auto first = std::find_if(records.begin(), records.end(),
                                  [](const TickRecord& record) { return record.touched; });
  REQUIRE(first != records.end());
  // Before the first mark there was no contact. Then it stays, whatever the application does.
  for (auto record = records.begin(); record != first; ++record) CHECK_FALSE(record->contact);
  CHECK(std::all_of(first, records.end(), [](const TickRecord& record) { return record.touched; }));
  beside.leave();
  REQUIRE(eventually([&] {
    const auto later = beside.records();
    return !later.empty() && later.back().touched;
  }));
}

TEST_CASE("Records say that an application made an object feel different, or added one") {
  const bool adds = GENERATE(false, true);
  LoopBeside beside;
  auto material = sized<spm_client_material>();
  material.fields = SPM_CLIENT_STIFFNESS;
  material.stiffness = 500;
  const spm_client_pose pose = raised(1);
  std::uint64_t added = 0;
  const int code = adds ? spm_client_add_object(beside.here->client, 0, &pose, 1, nullptr, &added)
                        : spm_client_set_material(beside.here->client, 0, &material);
  REQUIRE(code == SPM_CLIENT_OK);
  CHECK(eventually([&] {
    const auto records = beside.records();
    return !records.empty() && records.back().touched;
  }));
}

TEST_CASE("Objects that an application adds push, feel as it says, and leave with it") {
  LoopBeside beside;
  auto material = sized<spm_client_material>();
  material.fields = SPM_CLIENT_STIFFNESS;
  material.stiffness = 500;
  const spm_client_pose up = raised(2 * above);
  std::uint64_t added = 0;
  REQUIRE(spm_client_add_object(beside.here->client, 0, &up, 1, &material, &added) ==
          SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0.5));
  material.stiffness = 800;
  REQUIRE(spm_client_set_material(beside.here->client, added, &material) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0.8));
  REQUIRE(spm_client_remove_object(beside.here->client, added) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0));
  REQUIRE(spm_client_add_object(beside.here->client, 0, &up, 1, &material, &added) ==
          SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(0.8));
  const std::string path = beside.leave();
  const Connected other(path);
  REQUIRE(eventually([&] {
    auto read = sized<spm_client_device>();
    static_cast<void>(spm_client_read_device(other.client, 0, &read));
    return read.tick > 0 && read.contact == 0;
  }));
}

TEST_CASE("The slew limit is that of the stiffest object there is, and holds no motion back") {
  LoopBeside beside;
  const auto counts = [&] {
    auto read = sized<spm_client_device_counts>();
    static_cast<void>(spm_client_read_device_counts(beside.here->client, 0, &read));
    return read;
  };
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  auto material = sized<spm_client_material>();
  material.fields = SPM_CLIENT_STIFFNESS;
  material.stiffness = 5000;
  REQUIRE(spm_client_set_material(beside.here->client, 0, &material) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(5));
  beside.hand_x.store(0.007);
  const std::uint64_t tick = beside.device().tick;
  REQUIRE(eventually([&] { return beside.device().tick > tick + 2; }));
  beside.hand_x.store(0.014);
  const std::uint64_t next = beside.device().tick;
  REQUIRE(eventually([&] { return beside.device().tick > next + 2; }));
  beside.hand_x.store(0.021);
  REQUIRE(beside.comes_to(0));
  // Long enough for the force to have faded in, had there been one.
  const std::uint64_t out = beside.device().tick;
  REQUIRE(eventually([&] { return beside.device().tick > out + 200; }));
  const std::uint64_t held = counts().slew_hits;
  // 5 N in a tick: what the stiffness that the scene began with allows is 2 N.
  beside.hand_x.store(0.015);
  REQUIRE(beside.comes_to(5));
  CHECK(counts().slew_hits == held);
}

TEST_CASE("What belongs to the scene is not an application's to remove") {
  const LoopBeside beside;
  REQUIRE(spm_client_remove_object(beside.here->client, 0) == SPM_CLIENT_OK);
  CHECK(contains(beside.refusal(), "only who added it"));
}

TEST_CASE("A clutched hand moves freely, without force, and its tool stays") {
  LoopBeside beside;
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  REQUIRE(spm_client_set_clutch(beside.here->client, 0, 1) == SPM_CLIENT_OK);
  REQUIRE(eventually([&] { return beside.device().cause == SPM_CLIENT_OFF_CLUTCHED; }));
  for (int step = 1; step <= 50; ++step) {
    // Slower than what counts as a jump, however late the loop is.
    const std::uint64_t tick = beside.device().tick;
    beside.hand_x.store(1e-4 * step);
    REQUIRE(eventually([&] { return beside.device().tick > tick + 1; }));
  }
  CHECK(beside.device().position[0] == Approx(0).margin(1e-12));
  CHECK(beside.device().force[2] == 0);
  REQUIRE(spm_client_set_clutch(beside.here->client, 0, 0) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  CHECK(beside.device().position[0] == Approx(0).margin(1e-12));
}

TEST_CASE("While an application that moves objects hangs its scene is held, then let go") {
  const LoopBeside beside;
  const Connected other(beside.path());
  const auto seen = [&other] {
    auto read = sized<spm_client_device>();
    static_cast<void>(spm_client_read_device(other.client, 0, &read));
    return read;
  };
  const spm_client_pose up = raised(2 * above);
  // Poses that come one after the other, until both are sure to have come.
  REQUIRE(eventually([&] {
    static_cast<void>(spm_client_move_object(beside.here->client, 0, &up));
    return std::abs(seen().force[2] - 1) < 0.02;
  }));
  // The application does nothing from here on. For a second nothing changes.
  const std::uint64_t begun = seen().tick;
  REQUIRE(eventually([&] { return seen().cause == SPM_CLIENT_OFF_APPLICATION_SILENT; }));
  CHECK(seen().tick > begun + 1000);
  CHECK(seen().force[2] == 0);
  // Its next sign of life brings the force back.
  CHECK(beside.device().cause == SPM_CLIENT_OFF_APPLICATION_SILENT);
  REQUIRE(eventually([&] {
    static_cast<void>(beside.device());
    return std::abs(seen().force[2] - 1) < 0.02;
  }));
}

/// Poses one after the other, each half a millimetre on, at about 50 mm/s.
void slide(const LoopBeside& beside, int poses) {
  for (int i = 0; i < poses; ++i) {
    spm_client_pose pose = raised(2 * above);
    pose.position[0] = 5e-4 * i;
    REQUIRE(spm_client_move_object(beside.here->client, 0, &pose) == SPM_CLIENT_OK);
    const std::uint64_t tick = beside.device().tick;
    REQUIRE(eventually([&] { return beside.device().tick > tick + 9; }));
  }
}

TEST_CASE("An application whose poses end amid a motion hangs, although it reads") {
  const LoopBeside beside;
  slide(beside, 20);
  REQUIRE(beside.comes_to(1));
  const std::uint64_t begun = beside.device().tick;
  REQUIRE(eventually([&] { return beside.device().cause == SPM_CLIENT_OFF_APPLICATION_SILENT; }));
  CHECK(beside.device().tick > begun + 800);
  // A command of another kind is no sign of what moves the object; its next pose is.
  auto material = sized<spm_client_material>();
  material.fields = SPM_CLIENT_DAMPING;
  REQUIRE(spm_client_set_material(beside.here->client, 0, &material) == SPM_CLIENT_OK);
  const std::uint64_t off = beside.device().tick;
  REQUIRE(eventually([&] { return beside.device().tick > off + 100; }));
  CHECK(beside.device().cause == SPM_CLIENT_OFF_APPLICATION_SILENT);
  const spm_client_pose up = raised(2 * above);
  REQUIRE(spm_client_move_object(beside.here->client, 0, &up) == SPM_CLIENT_OK);
  CHECK(beside.comes_to(1));
}

TEST_CASE("An object whose last pose came twice was stopped, and is felt on") {
  const LoopBeside beside;
  slide(beside, 20);
  spm_client_pose last = raised(2 * above);
  last.position[0] = 5e-4 * 19;
  REQUIRE(spm_client_move_object(beside.here->client, 0, &last) == SPM_CLIENT_OK);
  REQUIRE(beside.comes_to(1));
  const std::uint64_t begun = beside.device().tick;
  REQUIRE(eventually([&] { return beside.device().tick > begun + 2000; }));
  CHECK(beside.device().cause == 0);
  CHECK(beside.device().force[2] == Approx(1).epsilon(0.05));
}

TEST_CASE("What an application moved stays where it is, and is felt, when the application leaves") {
  LoopBeside beside;
  const spm_client_pose up = raised(2 * above);
  REQUIRE(eventually([&] {
    static_cast<void>(spm_client_move_object(beside.here->client, 0, &up));
    return std::abs(beside.device().force[2] - 1) < 0.02;
  }));
  const Connected other(beside.leave());
  const auto seen = [&other] {
    auto read = sized<spm_client_device>();
    static_cast<void>(spm_client_read_device(other.client, 0, &read));
    return read;
  };
  REQUIRE(eventually([&] { return seen().tick > 0; }));
  const std::uint64_t begun = seen().tick;
  REQUIRE(eventually([&] { return seen().tick > begun + 2000; }));
  CHECK(seen().force[2] == Approx(1).epsilon(0.05));
}

}  // namespace app_scene_test
