// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/external/device_external.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "servo/devices/external/spm_external.h"
#include "servo/loop/loop.hpp"
#include "servo/shared/socket_path.hpp"
#include "tests/servo/support/eventually.hpp"
#include "tests/servo/support/served_tool_scene.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace device_external_test {

using namespace spm;
using namespace spm::servo;
using spm::test::TemporaryFolder;

namespace {

constexpr double place[3] = {0.01, 0.02, 0.03};
constexpr double level[4] = {1, 0, 0, 0};

/// A folder for the links, in place of the user's.
struct Runtime {
  TemporaryFolder folder;
  Runtime() { ::setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1); }
};

/// A daemon's device, and the process that drives it, in one.
struct Lent {
  Runtime runtime;
  DeviceExternal device;
  spm_external other{};

  Lent() : device(*parse_external_options("name=arm")) {
    REQUIRE(device.open({}));
    char message[1024] = "";
    REQUIRE(spm_external_open(&other, "arm", message, sizeof message) == 0);
  }
  ~Lent() { spm_external_close(&other); }
};

/// Writes a wrench and has the process read it, again where the test itself was silent between.
[[nodiscard]] bool arrives(Lent& lent, const Wrench& wrench, double* force, double* torque) {
  return test::eventually([&] {
    return lent.device.write(wrench) == DeviceHealth::ok &&
           spm_external_get_wrench(&lent.other, force, torque) == 1;
  });
}

void wait_for_silence() { std::this_thread::sleep_for(std::chrono::milliseconds(30)); }

}  // namespace

TEST_CASE("A pose comes to the loop and a wrench to the device's process") {
  Lent lent;
  const double turned[4] = {0.6, 0, 0.8, 0};
  spm_external_put_pose(&lent.other, place, turned, 5);
  DeviceState state;
  REQUIRE(lent.device.read(state) == DeviceHealth::ok);
  CHECK(state.position == Vector3(0.01, 0.02, 0.03));
  CHECK(state.orientation.coeffs() == Eigen::Quaterniond(0.6, 0, 0.8, 0).normalized().coeffs());
  CHECK(state.buttons == 5);
  double force[3] = {}, torque[3] = {};
  REQUIRE(arrives(lent, {Vector3(1, 2, 3), Vector3(4, 5, 6)}, force, torque));
  CHECK(force[2] == 3);
  CHECK(torque[0] == 4);
}

TEST_CASE("The torque of a loop whose hand holds a tool arrives at the device's process") {
  const Runtime runtime;
  test::ServedToolScene held;
  DeviceExternal device(*parse_external_options("name=arm,profile=omega3,torque_cap=300mNm"));
  REQUIRE(device.open({}));
  LoopSettings settings;
  settings.scene = held.world.scene;
  settings.tick_budget = 50;  // no time decides anything here
  TickRing ring = make_tick_ring(1000, 1);
  std::atomic<bool> stop{false};
  Loop loop(settings, {&device}, held.places(), ring, stop);
  spm_external other{};
  char message[1024] = "";
  REQUIRE(spm_external_open(&other, "arm", message, sizeof message) == 0);
  std::thread thread([&] { loop.run(); });
  // Two millimetres in the table, turned by a tenth of a radian about y: it is turned back.
  double force[3] = {}, torque[3] = {};
  const double turned[4] = {std::cos(0.05), 0, std::sin(0.05), 0};
  int frame = 0;
  const bool came = test::eventually([&] {
    const double down = std::min(1.0, ++frame / 100.0);
    const double pressed[3] = {0, 0, test::ToolScene::tool_size / 2 + 0.001 - 0.003 * down};
    spm_external_put_pose(&other, pressed, frame < 100 ? level : turned, 0);
    return spm_external_get_wrench(&other, force, torque) == 1 && torque[1] < -1e-3;
  });
  stop.store(true);
  thread.join();
  spm_external_close(&other);
  CHECK(came);
  CHECK(force[2] > 0);
  CHECK(std::abs(torque[0]) < std::abs(torque[1]));
}

TEST_CASE("Before a process supplies poses, and once it stops, the device is silent") {
  Lent lent;
  DeviceState state;
  CHECK(lent.device.read(state) == DeviceHealth::silent);
  spm_external_put_pose(&lent.other, place, level, 0);
  CHECK(lent.device.read(state) == DeviceHealth::ok);
  wait_for_silence();
  CHECK(lent.device.read(state) == DeviceHealth::silent);
  spm_external_put_pose(&lent.other, place, level, 0);
  CHECK(lent.device.read(state) == DeviceHealth::ok);
}

TEST_CASE("Once the daemon is silent its last wrench becomes zero") {
  Lent lent;
  double force[3] = {}, torque[3] = {};
  REQUIRE(arrives(lent, {Vector3(1, 2, 3), Vector3::Zero()}, force, torque));
  wait_for_silence();
  CHECK(spm_external_get_wrench(&lent.other, force, torque) == 0);
  CHECK((force[0] == 0 && force[1] == 0 && force[2] == 0));
}

TEST_CASE("Poses that are no numbers, and orientations that are not unit, are faults") {
  Lent lent;
  DeviceState state;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double nowhere[3] = {0, nan, 0};
  const double long_turn[4] = {1, 1, 0, 0};
  spm_external_put_pose(&lent.other, nowhere, level, 0);
  CHECK(lent.device.read(state) == DeviceHealth::fault);
  spm_external_put_pose(&lent.other, place, long_turn, 0);
  CHECK(lent.device.read(state) == DeviceHealth::fault);
  spm_external_put_pose(&lent.other, place, level, 0);
  CHECK(lent.device.read(state) == DeviceHealth::ok);
}

TEST_CASE("A wrench's latency counts from when the process wrote the pose") {
  Lent lent;
  DeviceState state;
  const auto latency = [&](const char* which) {
    return lent.device.describe()["latency_us"][which]["max"].get<double>();
  };
  const auto answer = [&] {
    REQUIRE(lent.device.read(state) == DeviceHealth::ok);
    REQUIRE(lent.device.write({Vector3(1, 2, 3), Vector3::Zero()}) == DeviceHealth::ok);
  };
  // The first may have lain there for long.
  spm_external_put_pose(&lent.other, place, level, 0);
  answer();
  CHECK(latency("report_to_command") == 0);
  // An older header writes no time, and a hostile process any.
  for (const std::uint64_t told : {std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0} >> 1U}) {
    spm_external_put_pose(&lent.other, place, level, 0);
    lent.other.memory->pose.time_ns = told;
    answer();
    CHECK(latency("report_age") == 0);
  }
  // A pose that is older than the time of silence counts from when it is read.
  CHECK(test::eventually([&] {
    spm_external_put_pose(&lent.other, place, level, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    answer();
    return latency("report_age") >= 3000;
  }));
  CHECK(latency("report_to_command") >= latency("report_age"));
}

TEST_CASE("A process that dies while it writes leaves silence, and the next one is understood") {
  Lent lent;
  DeviceState state;
  lent.other.memory->pose.sequence |= 1U;
  CHECK(lent.device.read(state) == DeviceHealth::silent);
  spm_external_put_pose(&lent.other, place, level, 0);
  CHECK(lent.device.read(state) == DeviceHealth::ok);
}

TEST_CASE("The memory cannot be shrunk under the loop") {
  const Lent lent;
  char path[512];
  REQUIRE(spm_external_path("arm", path, sizeof path) == 1);
  const int file = spm_external_open_file(path);
  REQUIRE(file >= 0);
  CHECK(::ftruncate(file, 0) != 0);
  ::close(file);
}

TEST_CASE("A hole that a process makes in the memory gives no force, and ends nothing") {
  Lent lent;
  DeviceState state;
  spm_external_put_pose(&lent.other, place, level, 0);
  REQUIRE(lent.device.read(state) == DeviceHealth::ok);
  char path[512];
  REQUIRE(spm_external_path("arm", path, sizeof path) == 1);
  const int file = spm_external_open_file(path);
  REQUIRE(file >= 0);
  const int punched = ::fallocate(file, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, 4096);
  ::close(file);
  REQUIRE(punched == 0);
  // All is zero now, also the length of the orientation: that is no pose.
  CHECK(lent.device.read(state) == DeviceHealth::fault);
  CHECK(lent.device.write({Vector3(1, 2, 3), Vector3::Zero()}) == DeviceHealth::ok);
  // A new process does not take it for the daemon's memory, and the old one goes on.
  spm_external next{};
  char message[1024] = "";
  CHECK(spm_external_open(&next, "arm", message, sizeof message) == -1);
  spm_external_put_pose(&lent.other, place, level, 0);
  CHECK(lent.device.read(state) == DeviceHealth::ok);
}

TEST_CASE("A process opens nothing through a hostile folder, nor what spm-servo did not make") {
  const Lent lent;
  const std::string folder = lent.runtime.folder.file("spm-servo");
  spm_external other{};
  char message[1024] = "";
  const auto opens = [&](const char* name) {
    message[0] = '\0';
    const bool opened = spm_external_open(&other, name, message, sizeof message) == 0;
    if (opened) spm_external_close(&other);
    return opened;
  };
  REQUIRE(opens("arm"));
  for (const mode_t mode : {0770, 0707, 01777}) {
    REQUIRE(::chmod(folder.c_str(), mode) == 0);
    CHECK_FALSE(opens("arm"));
    CHECK(std::string(message).find("not to be trusted") != std::string::npos);
    CHECK(std::string(message).find("set XDG_RUNTIME_DIR") != std::string::npos);
  }
  REQUIRE(::chmod(folder.c_str(), 0700) == 0);
  REQUIRE(opens("arm"));
  // A file of the right size in the place of the memory could be cut short.
  std::ofstream(folder + "/external-file") << std::string(sizeof(spm_external_memory), ' ');
  CHECK_FALSE(opens("file"));
  std::filesystem::create_symlink(folder + "/external-file", folder + "/external-link");
  CHECK_FALSE(opens("link"));
  if (::geteuid() == 0) {
    REQUIRE(::chown(folder.c_str(), 65534, 65534) == 0);
    CHECK_FALSE(opens("arm"));
    REQUIRE(::chown(folder.c_str(), 0, 0) == 0);
  }
  std::filesystem::rename(folder, folder + "-real");
  std::filesystem::create_directory_symlink(folder + "-real", folder);
  CHECK_FALSE(opens("arm"));
}

TEST_CASE("A daemon makes no memory in a hostile folder") {
  const Runtime runtime;
  const std::string folder = runtime.folder.file("spm-servo");
  DeviceExternal device(*parse_external_options("name=arm"));
  REQUIRE(::chmod(runtime.folder.path().c_str(), 0777) == 0);
  CHECK_FALSE(device.open({}));
  REQUIRE(::chmod(runtime.folder.path().c_str(), 0700) == 0);
  std::filesystem::rename(folder, folder + "-real");
  std::filesystem::create_directory_symlink(folder + "-real", folder);
  CHECK_FALSE(device.open({}));
  std::filesystem::remove(folder);
  std::filesystem::create_directory(folder);
  std::filesystem::permissions(folder, std::filesystem::perms::all);
  const auto open = device.open({});
  REQUIRE_FALSE(open);
  CHECK(open.error().message.find("open to writing by others") != std::string::npos);
}

TEST_CASE("The memory is found beside the daemon's socket, whatever the environment says") {
  const char* const before = std::getenv("XDG_RUNTIME_DIR");
  const std::string kept = before != nullptr ? before : "";
  for (const char* folder :
       {"/some/where", "not/absolute", "", static_cast<const char*>(nullptr)}) {
    folder != nullptr ? ::setenv("XDG_RUNTIME_DIR", folder, 1) : ::unsetenv("XDG_RUNTIME_DIR");
    char path[512] = "";
    const std::string beside = socket_folder();
    CHECK(spm_external_path("arm", path, sizeof path) == (beside.empty() ? 0 : 1));
    CHECK(path == (beside.empty() ? "" : beside + "/external-arm"));
  }
  before != nullptr ? ::setenv("XDG_RUNTIME_DIR", kept.c_str(), 1) : ::unsetenv("XDG_RUNTIME_DIR");
}

TEST_CASE("A name in use is refused, one that a daemon left behind is taken over") {
  Lent lent;
  DeviceExternal second(*parse_external_options("name=arm"));
  const auto refused = second.open({});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ExitCode::file_or_device);
  CHECK(refused.error().message.find("in use") != std::string::npos);
  const std::string left = lent.runtime.folder.file("spm-servo/external-left");
  std::filesystem::create_symlink("/proc/self/fd/1000", left);
  DeviceExternal third(*parse_external_options("name=left"));
  CHECK(third.open({}));
}

TEST_CASE("Where no daemon runs, the device's process is told what to start") {
  const Runtime runtime;
  spm_external other{};
  char message[1024] = "";
  REQUIRE(spm_external_open(&other, "nobody", message, sizeof message) == -1);
  CHECK(std::string(message).find("start spm-servo run --device external:name=nobody") !=
        std::string::npos);
}

TEST_CASE("External options that will not do are refused with what would") {
  for (const char* text :
       {"", "name=", "name=a/b", "name=a,profile=none", "name=a,x=1", "name", "name=a,turns=yes",
        "name=a,torque_cap=1N", "name=a,torque_cap=100Nm", "name=a,turns=off,torque_cap=1Nm"}) {
    const auto options = parse_external_options(text);
    REQUIRE_FALSE(options);
    CHECK(options.error().code == ExitCode::usage);
    CHECK(options.error().message.starts_with("--device external: "));
  }
  const auto options = parse_external_options("name=arm_1,profile=omega3");
  REQUIRE(options);
  CHECK(options->profile->name == "omega3");
  CHECK(options->turns);
  CHECK(options->torque_cap == 0);
}

TEST_CASE(
    "An external device has the torque that its options state, and turns unless they say no") {
  const DeviceExternal silent(*parse_external_options("name=a"));
  CHECK(silent.capabilities().turns);
  CHECK(hand_turning(silent.capabilities()).torque_cap == 0);
  const DeviceExternal strong(*parse_external_options("name=a,profile=omega3,torque_cap=400mNm"));
  const HandTurning turning = hand_turning(strong.capabilities());
  CHECK(turning.reads);
  CHECK(turning.torque_cap == 0.4);
  CHECK(turning.turn_step == Approx(90e-6));
  CHECK(turning.force_cap == 12);
  const DeviceExternal fixed(*parse_external_options("name=a,turns=off"));
  CHECK_FALSE(hand_turning(fixed.capabilities()).reads);
}

}  // namespace device_external_test
