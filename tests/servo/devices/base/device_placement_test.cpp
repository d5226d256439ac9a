// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/device_placement.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "common/base/random.hpp"
#include "servo/devices/base/device_placed.hpp"
#include "servo/devices/finder/device_list.hpp"

namespace device_placement_test {

using namespace spm;
using namespace spm::servo;

namespace {

/// All 48 axis options, in their text form.
std::vector<std::string> all_axes() {
  std::vector<std::string> all;
  std::string order = "xyz";
  do {
    for (int signs = 0; signs < 8; ++signs) {
      std::string text;
      for (int i = 0; i < 3; ++i) {
        text += ((signs >> i) & 1) != 0 ? '-' : '+';
        text += order[static_cast<std::size_t>(i)];
      }
      all.push_back(text);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

DeviceAxes axes_of(const std::string& text) {
  const auto axes = DeviceAxes::parse(text);
  REQUIRE(axes);
  return *axes;
}

Vector3 random_vector(Random& random) {
  return {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
}

Eigen::Quaterniond random_turn(Random& random) {
  return Eigen::Quaterniond(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1),
                            random.between(-1, 1))
      .normalized();
}

/// World from device.
Eigen::Matrix3d matrix_of(const DeviceAxes& axes) {
  Eigen::Matrix3d matrix;
  for (Eigen::Index i = 0; i < 3; ++i) matrix.col(i) = axes.to_world(Vector3(Vector3::Unit(i)));
  return matrix;
}

/// What a driver sees.
struct Seen {
  Wrench wrench;
  Placement workspace;
  std::int64_t until_ns = 0;
};

/// A driver that reports a given state as its measurement.
class ReportingDevice final : public Device {
 public:
  ReportingDevice(const DeviceState& state, Seen& seen) : state_(state), seen_(seen) {
    capabilities_.name = "told";
    capabilities_.stiffness_cap = 3000;
    capabilities_.workspace = Vector3(0.1, 0.2, 0.3);
  }

  [[nodiscard]] Result<void> open(const DeviceSetup& setup) override {
    seen_.workspace = setup.scene.workspace;
    capabilities_.encoder_step = 1e-5;
    return {};
  }
  [[nodiscard]] const DeviceCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] DeviceHealth read(DeviceState& state) noexcept override {
    if (leaves_state) return DeviceHealth::silent;
    state = state_;
    return DeviceHealth::ok;
  }
  [[nodiscard]] DeviceHealth write(const Wrench& wrench) noexcept override {
    seen_.wrench = wrench;
    return DeviceHealth::not_homed;
  }
  [[nodiscard]] bool wait_for_report(std::int64_t until_ns) noexcept override {
    seen_.until_ns = until_ns;
    return true;
  }
  [[nodiscard]] nlohmann::ordered_json describe() const override { return {{"told", true}}; }

  bool leaves_state = false;

 private:
  DeviceState state_;
  Seen& seen_;
  DeviceCapabilities capabilities_;
};

std::unique_ptr<Device> told(const std::string& axes, const DeviceState& state, Seen& seen) {
  DevicePlacement placement;
  placement.axes = axes_of(axes);
  return std::make_unique<PlacedDevice>(std::make_unique<ReportingDevice>(state, seen), placement);
}

}  // namespace

TEST_CASE("Axes are read as they are written, and nothing else is") {
  for (const std::string& text : all_axes()) REQUIRE(axes_of(text).text() == text);
  REQUIRE(axes_of("+x+y+z") == DeviceAxes{});
  REQUIRE(axes_of("+x-z+y").to_world(Vector3(1, 2, 3)) == Vector3(1, -3, 2));
  for (const char* text : {"", "xyz", "+x+y", "+x+y+z+x", "+x+y+y", "+x+y+w", "x+y+z+", "*x+y+z",
                           "+X+Y+Z", "+x +y+z", "++x+y+"}) {
    CAPTURE(text);
    REQUIRE_FALSE(DeviceAxes::parse(text));
  }
}

TEST_CASE("Half of all axes mirror: those whose determinant is negative") {
  int mirrors = 0;
  for (const std::string& text : all_axes()) {
    const DeviceAxes axes = axes_of(text);
    REQUIRE(axes.mirrored() == (matrix_of(axes).determinant() < 0));
    mirrors += axes.mirrored() ? 1 : 0;
  }
  REQUIRE(mirrors == 24);
}

TEST_CASE("Whatever the axes, a wrench does the same work in the device's frame and the world's") {
  Random random(1);
  for (const std::string& text : all_axes()) {
    const DeviceAxes axes = axes_of(text);
    for (int i = 0; i < 50; ++i) {
      Seen seen;
      const DeviceState before{random_vector(random), random_turn(random), 0};
      const Vector3 step = 1e-3 * random_vector(random);
      const Vector3 turn = 1e-3 * random_vector(random);  // rad, device frame
      const DeviceState after{before.position + step, before.orientation, 0};
      const Wrench wrench{random_vector(random), random_vector(random)};

      DeviceState world_before, world_after;
      REQUIRE(told(text, before, seen)->read(world_before) == DeviceHealth::ok);
      const auto device = told(text, after, seen);
      REQUIRE(device->read(world_after) == DeviceHealth::ok);
      REQUIRE(device->write(wrench) == DeviceHealth::not_homed);
      const Vector3 world_step = world_after.position - world_before.position;
      REQUIRE(wrench.force.dot(world_step) ==
              Approx(seen.wrench.force.dot(step)).margin(1e-15).epsilon(1e-9));
      REQUIRE(wrench.torque.dot(axes.turn_to_world(turn)) ==
              Approx(seen.wrench.torque.dot(turn)).margin(1e-15).epsilon(1e-9));
      REQUIRE(seen.wrench.force.norm() == Approx(wrench.force.norm()));
    }
  }
}

TEST_CASE("An orientation is conjugated, stays a turn in a mirror, and turns as it is turned") {
  Random random(2);
  for (const std::string& text : all_axes()) {
    const DeviceAxes axes = axes_of(text);
    const Eigen::Matrix3d matrix = matrix_of(axes);
    REQUIRE(axes.to_world(Eigen::Quaterniond::Identity()).coeffs() ==
            Eigen::Quaterniond::Identity().coeffs());
    for (int i = 0; i < 50; ++i) {
      const Eigen::Quaterniond turned = random_turn(random);
      const Eigen::Quaterniond world = axes.to_world(turned);
      REQUIRE(world.norm() == Approx(1).epsilon(1e-15));
      REQUIRE((world.toRotationMatrix() - matrix * turned.toRotationMatrix() * matrix.transpose())
                  .cwiseAbs()
                  .maxCoeff() < 1e-14);
      REQUIRE(axes.from_world(world).coeffs() == turned.coeffs());
      // A small turn of the tool, by its angular velocity in either frame.
      const Vector3 rate = random_vector(random);
      const auto by = [](const Vector3& vector) {
        return Eigen::Quaterniond(Eigen::AngleAxisd(1e-3 * vector.norm(), vector.normalized()));
      };
      const Eigen::Quaterniond next = axes.to_world(by(rate) * turned);
      REQUIRE(next.angularDistance(by(axes.turn_to_world(rate)) * world) < 1e-7);
    }
  }
}

TEST_CASE("A placed device's limits are the user's where these are given, else the driver's") {
  Seen seen;
  DevicePlacement placement;
  placement.axes = axes_of("-z+x+y");
  PlacedDevice turned(std::make_unique<ReportingDevice>(DeviceState{}, seen), placement);
  REQUIRE(turned.capabilities().workspace == Vector3(0.3, 0.1, 0.2));
  REQUIRE(turned.capabilities().stiffness_cap == 3000);
  REQUIRE(turned.capabilities().clutch_button == 0);
  REQUIRE(turned.open({}));
  REQUIRE(turned.capabilities().encoder_step == 1e-5);
  REQUIRE(turned.describe().at("world_axes") == "-z+x+y");
  REQUIRE(turned.describe().at("told") == true);

  placement.workspace = Vector3(0.01, 0.02, 0.03);
  placement.stiffness_cap = 500;
  placement.clutch_button = 32;
  PlacedDevice limited(std::make_unique<ReportingDevice>(DeviceState{}, seen), placement);
  REQUIRE(limited.open({}));
  REQUIRE(limited.capabilities().workspace == Vector3(0.01, 0.02, 0.03));
  REQUIRE(limited.capabilities().stiffness_cap == 500);
  REQUIRE(limited.capabilities().clutch_button == 32);
  REQUIRE(limited.wait_for_report(42));
  REQUIRE(seen.until_ns == 42);
}

TEST_CASE("What a driver leaves as it was is not turned a second time") {
  Seen seen;
  auto driver = std::make_unique<ReportingDevice>(DeviceState{}, seen);
  driver->leaves_state = true;
  DevicePlacement placement;
  placement.axes = axes_of("+y-z+x");
  PlacedDevice placed(std::move(driver), placement);
  Random random(3);
  const DeviceState before{random_vector(random), random_turn(random), 6};
  DeviceState state = before;
  for (int i = 0; i < 3; ++i) REQUIRE(placed.read(state) == DeviceHealth::silent);
  REQUIRE(state.position == before.position);
  REQUIRE(state.orientation.coeffs() == before.orientation.coeffs());
  REQUIRE(state.buttons == 6);
}

TEST_CASE("A driver is told the scene in its own frame") {
  Random random(4);
  for (const std::string& text : all_axes()) {
    const DeviceAxes axes = axes_of(text);
    if (axes.mirrored()) continue;
    DeviceSetup setup;
    setup.scene.workspace = {random_vector(random), random_turn(random), 2};
    Seen seen;
    REQUIRE(told(text, {}, seen)->open(setup));
    const Vector3 hand = random_vector(random);
    REQUIRE((seen.workspace.to_world(hand) - setup.scene.workspace.to_world(axes.to_world(hand)))
                .norm() < 1e-14);
  }
}

TEST_CASE("The options of any device are taken out of those of its driver") {
  const auto all = take_placement("arm",
                                  "name=a,axes=-x+z+y,profile=low,clutch_button=2,stiffness_cap="
                                  "1.5N/mm,workspace=100mmx8cmx0.06m");
  REQUIRE(all);
  REQUIRE(all->own == "name=a,profile=low");
  REQUIRE(all->placement.axes.text() == "-x+z+y");
  REQUIRE(all->placement.clutch_button == 2);
  REQUIRE(all->placement.stiffness_cap == 1500.0);
  REQUIRE((*all->placement.workspace - Vector3(0.05, 0.04, 0.03)).norm() < 1e-15);
  const auto off = take_placement("arm", "workspace=off");
  REQUIRE(off);
  REQUIRE(off->own.empty());
  REQUIRE(off->placement.workspace == Vector3(0, 0, 0));
  const auto none = take_placement("arm", "speed=1m/s");
  REQUIRE(none);
  REQUIRE(none->placement == DevicePlacement{});
  REQUIRE(none->own == "speed=1m/s");
}

TEST_CASE("An option of any device that will not do is a usage error that says what would") {
  const auto [text, hint] = GENERATE(table<std::string, std::string>({
      {"axes=xyz", "axes=+x+y+z"},
      {"axes=+x+x+z", "once"},
      {"axes=", "axes=+x+y+z"},
      {"axes=+x+y+z,axes=+x+y+z", "twice"},
      {"clutch_button=0", "1 to 32"},
      {"clutch_button=33", "1 to 32"},
      {"clutch_button=-1", "1 to 32"},
      {"clutch_button=1.5", "1 to 32"},
      {"clutch_button=", "1 to 32"},
      {"clutch_button=4294967297", "1 to 32"},
      {"stiffness_cap=1", "unit"},
      {"stiffness_cap=0N/m", "out of range"},
      {"stiffness_cap=-1N/m", "out of range"},
      {"stiffness_cap=6N/mm", "at most 5 N/mm"},
      {"stiffness_cap=1,5N/mm", ""},
      {"workspace=100mm", "three edges"},
      {"workspace=1mmx1mm", "three edges"},
      {"workspace=1mmx1mmx1mmx1mm", "three edges"},
      {"workspace=1x1x1", "unit"},
      {"workspace=1mmx1mmx", ""},
      {"workspace=1mmx0mmx1mm", "out of range"},
      {"workspace=1mmx1mmx11m", "out of range"},
      {"workspace=no", "workspace=off"},
  }));
  CAPTURE(text);
  const auto options = make_device("sim:" + text);
  REQUIRE_FALSE(options);
  REQUIRE(options.error().code == ExitCode::usage);
  REQUIRE(options.error().message.starts_with("--device sim: "));
  REQUIRE(options.error().message.find(hint) != std::string::npos);
}

TEST_CASE("Every device takes the options of any device, and tells the limits of its profile") {
  struct Expected {
    std::string device;
    double stiffness_cap;
    Vector3 workspace;
  };
  const double none = std::numeric_limits<double>::infinity();
  for (const Expected& expected :
       {Expected{"sim", none, {0, 0, 0}}, Expected{"falcon", 3000, {0.051, 0.051, 0.051}},
        Expected{"woodenhaptics", 1000, {0, 0, 0}},
        Expected{"external:name=arm", 400, {0.2155, 0.174, 0.0825}},
        Expected{"external:name=arm,profile=falcon", 3000, {0.051, 0.051, 0.051}},
        Expected{"spacemouse", none, {0, 0, 0}}}) {
    CAPTURE(expected.device);
    const auto plain = make_device(expected.device);
    REQUIRE(plain);
    REQUIRE((*plain)->capabilities().stiffness_cap == expected.stiffness_cap);
    REQUIRE(((*plain)->capabilities().workspace - expected.workspace).norm() < 1e-12);
    REQUIRE((*plain)->capabilities().clutch_button == 0);
    const char* const join = expected.device.find(':') == std::string::npos ? ":" : ",";
    const auto placed =
        make_device(expected.device + join + "clutch_button=3,axes=+x-z+y,stiffness_cap=200N/m");
    REQUIRE(placed);
    const DeviceCapabilities& can = (*placed)->capabilities();
    REQUIRE(can.name == (*plain)->capabilities().name);
    REQUIRE(can.force_cap == (*plain)->capabilities().force_cap);
    REQUIRE(can.clutch_button == 3);
    REQUIRE(can.stiffness_cap == 200);
    REQUIRE((can.workspace -
             Vector3(expected.workspace.x(), expected.workspace.z(), expected.workspace.y()))
                .norm() < 1e-12);
  }
}

TEST_CASE("A simulated hand is not planned in a mirrored frame, but follows a file in one") {
  const auto planned = make_device("sim:axes=-x+y+z");
  REQUIRE_FALSE(planned);
  REQUIRE(planned.error().code == ExitCode::usage);
  REQUIRE(planned.error().message.find("hand=path") != std::string::npos);
  REQUIRE(make_device("sim:axes=-x+y+z,path=slide.txt"));
  REQUIRE(make_device("sim:axes=-x-y+z"));
  REQUIRE(make_device("falcon:axes=-x+y+z"));
}

}  // namespace device_placement_test
