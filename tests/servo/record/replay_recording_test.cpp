// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/motion/recording.hpp"
#include "servo/base/clock.hpp"
#include "servo/client/spm_client.h"
#include "servo/record/recorded_scene.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/servo_program.hpp"

namespace command_test {

using nlohmann::json;

namespace {

/// The report of a replay's comparison, for a replay that ends with this code.
json compared(const Workshop& shop, std::vector<std::string> words, int code) {
  words.insert(words.begin(), "replay");
  words.emplace_back("--json");
  const Outcome replay = servo(shop.folder, words);
  CAPTURE(replay.err, replay.out);
  REQUIRE(replay.code == code);
  return json::parse(replay.out)["recording"];
}

/// A supervisor that moves, adds, changes and removes objects for a while, and chooses method and
/// stabilization.
void play_with_objects(const std::string& socket) {
  spm_client_options options{};
  options.size = sizeof options;
  options.path = socket.c_str();
  options.application = "test";
  options.role = SPM_CLIENT_SUPERVISOR;
  spm_client* client = nullptr;
  REQUIRE(spm::test::eventually(
      [&] { return spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_OK; }));
  REQUIRE(spm::test::eventually([&] {
    double age = -1;
    return spm_client_daemon_state(client, &age) == SPM_CLIENT_RUNNING && age >= 0;
  }));
  spm_client_pose pose{};
  pose.size = sizeof pose;
  pose.orientation[0] = 1;
  pose.period = 0.01;
  std::uint64_t added = 0;
  for (int frame = 0; frame < 120; ++frame) {
    pose.position[2] = 1e-3 * std::sin(0.2 * frame);
    REQUIRE(spm_client_move_object(client, 0, &pose) == SPM_CLIENT_OK);
    if (frame == 30) {
      spm_client_material material{};
      material.size = sizeof material;
      material.fields = SPM_CLIENT_STIFFNESS | SPM_CLIENT_FRICTION;
      material.stiffness = 700;
      material.friction_stick = material.friction_slide = 0.3;
      REQUIRE(spm_client_set_material(client, 0, &material) == SPM_CLIENT_OK);
      spm_client_pose beside = pose;
      beside.position[0] = 1e-3;
      REQUIRE(spm_client_add_object(client, 0, &beside, 1, nullptr, &added) == SPM_CLIENT_OK);
    }
    if (frame == 50 || frame == 70) {
      const std::uint32_t method = frame == 50 ? SPM_CLIENT_METHOD_SPM : SPM_CLIENT_METHOD_PROXY;
      REQUIRE(spm_client_set_method(client, 0, method) == SPM_CLIENT_OK);
      REQUIRE(spm_client_stabilize(client, frame == 50 ? 0 : 1) == SPM_CLIENT_OK);
    }
    if (frame == 80) REQUIRE(spm_client_remove_object(client, added) == SPM_CLIENT_OK);
    spm::servo::sleep_until(spm::servo::now_ns() + 10'000'000);
  }
  spm_client_disconnect(client);
}

}  // namespace

TEST_CASE("A recording replays without any option, whatever its forces came from") {
  const Workshop shop;
  const std::string recording = shop.folder.file("run.spmrec");
  const std::string scene = shop.scene(
      "[stabilization]\nrecommended = true\n[device]\nprofile = \"falcon\"\n"
      "[workspace]\npose = [0.1, 0, 0]\n"
      "[[object]]\nasset = \"sparse.spm.exr\"\npose = [0.1, 0, 0]\nscale = 1.5\n"
      "stiffness = \"0.7N/mm\"\nfriction = { slide = 0.3, stick = 0.5 }\ndamping = \"1Ns/m\"\n"
      "texture = { amplitude = \"50\u00B5m\", wavelength = \"2mm\" }\n"
      "[[object]]\nasset = \"full.spm.exr\"\npose = [0.1, 0.01, 0]\nmethod = \"paper\"\n"
      "texture = { noise = \"20um\" }\n"
      "[[object]]\nasset = \"sparse.spm.exr\"\npose = [0.11, 0, 0]\nmethod = \"proxy\"\n");
  const std::string capsule = shop.scene(
      "[tool]\nprobe = \"capsule:0.4mm,5mm\"\n"
      "[workspace]\npose = [0.1, 0, 0, 0.8, 0.6, 0, 0]\n"
      "[[object]]\nasset = \"full.spm.exr\"\npose = [0.1, 0, 0, 0.6, 0, 0.8, 0]\n"
      "method = \"paper\"\nfriction = { force = \"0.1N\" }\n");
  for (const std::vector<std::string>& forces :
       {std::vector<std::string>{"--asset", shop.sparse, "--method", "proxy", "--stiffness",
                                 "0.8N/mm", "--stabilization", "recommended"},
        std::vector<std::string>{"--asset", shop.full, "--method", "paper", "--paper-rule",
                                 "all-planes"},
        std::vector<std::string>{"--asset", shop.full, "--method", "paper", "--probe",
                                 "sphere:0.5mm"},
        std::vector<std::string>{"--asset", shop.full, "--method", "paper", "--probe",
                                 "capsule:0.5mm,6mm", "--paper-probe", "volume", "--stabilization",
                                 "recommended"},
        std::vector<std::string>{"--scene", capsule}, std::vector<std::string>{"--scene", scene}}) {
    std::vector<std::string> words{"run",      "--duration", "1",        "--record",      recording,
                                   "--device", "sim:seed=3", "--device", "sim:hand=push", "--json"};
    words.insert(words.end(), forces.begin(), forces.end());
    CAPTURE(forces);
    const Outcome run = servo(shop.folder, words);
    REQUIRE(run.code == 0);
    const json report = compared(shop, {recording}, 0);
    CHECK(report["forces_equal"] == true);
    CHECK(report["differs"].empty());
    // Every tick of both devices.
    const json told = json::parse(run.out);
    CHECK(report["compared_ticks"] == 2 * told["ticks"].get<int>());
    CHECK(told["contact_ticks"].get<int>() > 0);
    const auto read = spm::read_recording(recording);
    REQUIRE(read);
    CHECK(read->header.devices[0].force_cap == 12);
  }
}

TEST_CASE("A recording with objects that an application moved, added and changed replays whole") {
  const Workshop shop;
  const std::string recording = shop.folder.file("run.spmrec");
  const std::string socket = shop.folder.file("a.sock");
  const std::string scene = shop.scene(
      "[[object]]\nasset = \"sparse.spm.exr\"\nmovable = true\n"
      "[stabilization]\nrecommended = true\n");
  const Program run(shop.folder, {"run", "--scene", scene, "--device", "sim", "--record", recording,
                                  "--socket", socket, "--json"});
  play_with_objects(socket);
  run.signal(SIGTERM);
  const Outcome done = run.wait();
  REQUIRE(done.code == 0);
  const auto read = spm::read_recording(recording);
  REQUIRE(read);
  CHECK(read->changes.size() > 300);
  CHECK(spm::servo::recorded_scene(read->header.scene, read->header.assets.size()));
  const json report = compared(shop, {recording}, 0);
  CHECK(report["forces_equal"] == true);
  CHECK(report["compared_ticks"] == json::parse(done.out)["ticks"]);
  // By the scene's file, which says nothing of the moves, only what came before them.
  const json first = compared(shop, {recording, "--scene", scene}, 0);
  CHECK(first["scene_changed"]["by"] == "application");
  CHECK(first["compared_ticks"] < report["compared_ticks"]);
}

namespace {

/// An application that pushes a hand and sets an effect of every kind on it for a while.
void push_and_pull(const std::string& socket) {
  spm_client_options options{};
  options.size = sizeof options;
  options.path = socket.c_str();
  spm_client* client = nullptr;
  REQUIRE(spm::test::eventually(
      [&] { return spm_client_connect(&options, &client, nullptr, 0) == SPM_CLIENT_OK; }));
  REQUIRE(spm::test::eventually(
      [&] { return spm_client_set_force_cap(client, 0, 2) == SPM_CLIENT_OK; }));
  for (std::uint32_t kind = SPM_CLIENT_SPRING; kind <= SPM_CLIENT_DETENTS; ++kind) {
    spm_client_effect effect{};
    effect.size = sizeof effect;
    effect.kind = kind;
    effect.stiffness = 50;
    effect.damping = 1;
    effect.most_force = 0.5;
    effect.spacing = 2e-3;
    effect.axis[2] = 1;
    REQUIRE(spm_client_set_effect(client, 0, kind, &effect) == SPM_CLIENT_OK);
  }
  for (int frame = 0; frame < 100; ++frame) {
    spm_client_push push{};
    push.size = sizeof push;
    push.force[0] = 3 * std::sin(0.2 * frame);
    push.hold = 0.05;
    REQUIRE(spm_client_push_hand(client, 0, &push) == SPM_CLIENT_OK);
    spm::servo::sleep_until(spm::servo::now_ns() + 10'000'000);
  }
  spm_client_disconnect(client);
}

}  // namespace

TEST_CASE("A recording with pushes and effects of an application replays whole") {
  const Workshop shop;
  const std::string recording = shop.folder.file("run.spmrec");
  const std::string socket = shop.folder.file("a.sock");
  const Program run(shop.folder,
                    {"run", "--asset", shop.sparse, "--stabilization", "recommended", "--device",
                     "sim", "--record", recording, "--socket", socket, "--json"});
  push_and_pull(socket);
  run.signal(SIGTERM);
  const Outcome done = run.wait();
  REQUIRE(done.code == 0);
  const json report = compared(shop, {recording}, 0);
  CHECK(report["forces_equal"] == true);
  CHECK(report["compared_ticks"] == json::parse(done.out)["ticks"]);
  CHECK(report["ticks_with_added_force"] > 100);
  const auto read = spm::read_recording(recording);
  REQUIRE(read);
  std::uint64_t touching = 0;
  for (const spm::RecordingRow& row : read->rows) {
    const bool added = row.added[0] != 0 || row.added[1] != 0 || row.added[2] != 0;
    touching += added && (row.flags & spm::recorded_contact) != 0 ? 1 : 0;
  }
  // Otherwise the account of energy was not put to the proof.
  CHECK(touching > 20);
}

TEST_CASE("A replay whose forces differ says which settings or which asset differ, and exits 10") {
  const Workshop shop;
  const std::string recording = shop.folder.file("run.spmrec");
  REQUIRE(servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "0.5", "--record",
                              recording, "--device", "sim:seed=3"})
              .code == 0);
  const auto told = [&](const std::vector<std::string>& more, const std::string& part) {
    std::vector<std::string> words{"replay", recording};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome replay = servo(shop.folder, words);
    CAPTURE(replay.err, part);
    CHECK(replay.code == 10);
    require_one_sentence(replay.err);
    CHECK(replay.err.find("forces differ from the recording's") != std::string::npos);
    CHECK(replay.err.find(part) != std::string::npos);
  };
  told({"--stiffness", "2N/mm"}, "object 0: stiffness");
  told({"--stiffness", "2N/mm", "--stabilization", "none"}, "stabilization");
  // Another file with the name that the asset had.
  spm::test::write(spm::test::shape_asset(spm::test::box({0.03, 0.03, 0.03})), shop.sparse);
  told({}, "asset 0 is another file (" + shop.sparse);
}

TEST_CASE("A recording of a scene whose default changed since replays as it was felt") {
  const Workshop shop;
  const std::string recording = shop.folder.file("run.spmrec");
  const std::string object = "[[object]]\nasset = \"sparse.spm.exr\"\nstiffness = \"0.5N/mm\"\n";
  // What was once the default, as if nothing of it had been named.
  const std::string scene =
      shop.scene("[stabilization]\ndamping = 0\n" + object + "method = \"spm\"\n");
  REQUIRE(servo(shop.folder, {"run", "--scene", scene, "--duration", "0.5", "--record", recording,
                              "--device", "sim:seed=3"})
              .code == 0);
  // Today's default is another; the scene names neither.
  std::ofstream(scene) << object;
  CHECK(compared(shop, {recording}, 0)["forces_equal"] == true);
  const json told = compared(shop, {recording, "--scene", scene}, 10);
  CHECK(told["forces_equal"] == false);
  CHECK(told["differs"].dump().find("method") != std::string::npos);
  CHECK(told["differs"].dump().find("stabilization") != std::string::npos);
}

TEST_CASE("An asset that is gone is looked for beside the recording, or told") {
  const Workshop shop;
  const std::string recording = shop.folder.file("run.spmrec");
  REQUIRE(servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "0.3", "--record",
                              recording, "--device", "sim"})
              .code == 0);
  const std::string other = shop.folder.file("other");
  std::filesystem::create_directories(other);
  std::filesystem::rename(shop.sparse, other + "/sparse.spm.exr");
  const Outcome gone = servo(shop.folder, {"replay", recording});
  CHECK(gone.code == 2);
  require_one_sentence(gone.err);
  CHECK(gone.err.starts_with("error: " + recording + ": " + shop.sparse + ": "));
  std::filesystem::rename(recording, other + "/run.spmrec");
  CHECK(compared(shop, {other + "/run.spmrec"}, 0)["forces_equal"] == true);
}

TEST_CASE("A daemon that is killed leaves its last ticks, which replay bit by bit") {
  const Workshop shop;
  const std::string kept = shop.folder.file("made/black-box.spmrec");
  const std::string socket = shop.folder.file("a.sock");
  const std::string scene = shop.scene(
      "[[object]]\nasset = \"sparse.spm.exr\"\nmovable = true\nmethod = \"proxy\"\n"
      "[stabilization]\nrecommended = true\n");
  const Program run(shop.folder, {"run", "--scene", scene, "--device", "sim", "--black-box", kept,
                                  "--socket", socket});
  play_with_objects(socket);
  run.signal(SIGKILL);
  static_cast<void>(run.wait());
  REQUIRE(spm::test::eventually([&] { return std::filesystem::exists(kept); }));
  // Before another program writes to the same file.
  CHECK(spm::test::eventually(
      [&] { return content(shop.folder.file("stderr")).find(kept) != std::string::npos; }));
  const auto read = spm::read_recording(kept);
  REQUIRE(read);
  CHECK(read->rows.size() > 1200);
  CHECK(read->changes.size() > 300);
  const json report = compared(shop, {kept}, 0);
  CHECK(report["forces_equal"] == true);
  CHECK(report["compared_ticks"] == read->rows.size());
}

TEST_CASE("A daemon that ends in order, or has no black box, leaves none") {
  const Workshop shop;
  const std::string kept = shop.folder.file("black-box.spmrec");
  REQUIRE(servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "0.3", "--device", "sim",
                              "--black-box", kept})
              .code == 0);
  const Program run(shop.folder,
                    {"run", "--asset", shop.sparse, "--device", "sim", "--black-box", "off"});
  spm::servo::sleep_until(spm::servo::now_ns() + 500'000'000);
  run.signal(SIGKILL);
  static_cast<void>(run.wait());
  spm::servo::sleep_until(spm::servo::now_ns() + 300'000'000);
  CHECK_FALSE(std::filesystem::exists(kept));
}

}  // namespace command_test
