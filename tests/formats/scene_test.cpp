// SPDX-License-Identifier: Apache-2.0
#include "formats/scene.hpp"

#include <catch2/catch.hpp>
#include <clocale>
#include <cmath>

#include "tests/formats/synthetic_asset.hpp"

namespace {

using namespace spm;
using namespace spm::test;

Result<Scene> read(const std::string& text) {
  const TemporaryFolder folder;
  write_bytes(folder.path("scene.toml"), text);
  return read_scene(folder.path("scene.toml"));
}

}  // namespace

TEST_CASE("A scene's keys become SI, its paths relative to its own folder") {
  const TemporaryFolder folder;
  write_bytes(folder.path("scene.toml"), R"(
[device]
driver = "falcon"
profile = "falcon"
force_cap = "6N"

[tool]
probe = "sphere:0.5mm"

[workspace]
pose = [0, 0.1, 0]
scale = 2

[[object]]
mesh = "meshes/teeth.obj"
asset = "/somewhere/teeth.spm.exr"
pose = [0.1, 0, -2e-2, 0.70711, 0, 0.70711, 0]
scale = 1.5
stiffness = "0.8N/mm"

[[object]]
asset = "spot.spm.exr"
)");
  const auto scene = read_scene(folder.path("scene.toml"));
  REQUIRE(scene);
  CHECK(scene->device.driver == "falcon");
  CHECK(scene->device.profile == find_device_profile("falcon"));
  CHECK(scene->device.force_cap == 6.0);
  CHECK(*scene->probe_radius == Approx(5e-4));
  CHECK(scene->workspace.position == Vector3(0, 0.1, 0));
  CHECK(scene->workspace.scale == 2);
  REQUIRE(scene->objects.size() == 2);
  const SceneObject& teeth = scene->objects[0];
  CHECK(teeth.mesh == folder.path("meshes/teeth.obj"));
  CHECK(teeth.asset == "/somewhere/teeth.spm.exr");
  CHECK(teeth.placement.position == Vector3(0.1, 0, -0.02));
  CHECK((teeth.placement.rotation * Vector3::UnitZ() - Vector3::UnitX()).norm() < 1e-5);
  CHECK(std::abs(teeth.placement.rotation.norm() - 1) < 1e-12);
  CHECK(teeth.placement.scale == 1.5);
  CHECK(teeth.stiffness == Approx(800));
  CHECK(teeth.line == 14);
  CHECK(scene->objects[1].asset == folder.path("spot.spm.exr"));
  CHECK(scene->objects[1].mesh.empty());
}

TEST_CASE("What a scene leaves out has a default or stays open") {
  const auto scene = read("[[object]]\nmesh = \"a.obj\"\n");
  REQUIRE(scene);
  CHECK(scene->device.driver.empty());
  CHECK(scene->device.profile == nullptr);
  CHECK_FALSE(scene->device.force_cap);
  CHECK_FALSE(scene->probe_radius);
  CHECK(scene->workspace.position == Vector3::Zero());
  CHECK(scene->workspace.scale == 1);
  CHECK(scene->objects[0].stiffness == 1000);
  CHECK_FALSE(scene->objects[0].stiffness_given);
  CHECK(scene->objects[0].placement.scale == 1);
  const auto point = read("tool.probe = \"point\"\n[[object]]\nmesh = \"a.obj\"\n");
  REQUIRE(point);
  CHECK(point->probe_radius == 0.0);
}

TEST_CASE("What is wrong in a scene is told by its line, cause and cure") {
  struct Case {
    const char* text;
    const char* place;
    const char* cause;
  };
  for (const Case& wrong : {
           Case{"", "line 1", "needs an object"},
           Case{"object = 3\n", "line 1", "[[object]]"},
           Case{"[object]\nmesh = \"a.obj\"\n", "line 1", "[[object]]"},
           Case{"\n[[object]]\npose = [0, 0, 0]\n", "line 2", "needs 'mesh'"},
           Case{"[[object]]\nmesh = 3\n", "line 2", "'mesh' must be text"},
           Case{"[[object]]\nmesh = \"\"\n", "line 2", "'mesh' must be text"},
           Case{"[[object]]\nmsh = \"a.obj\"\n", "line 2", "did you mean 'mesh'?"},
           Case{"[[object]]\ncolour = 1\n", "line 2", "its keys are asset mesh pose scale"},
           Case{"[tools]\n", "line 1", "did you mean 'tool'?"},
           Case{"[physics]\n", "line 1", "its keys are device tool workspace object"},
           Case{"device = \"sim\"\n", "line 1", "write [device]"},
           Case{"[device]\nprofile = \"falcn\"\n", "line 2", "low falcon touch omega3 wooden"},
           Case{"[device]\nforce_cap = 3\n", "line 2", "\"3N\""},
           Case{"[device]\nforce_cap = \"3\"\n", "line 2", "unit"},
           Case{"[device]\nforce_cap = \"3mm\"\n", "line 2", "unknown unit"},
           Case{"[device]\nforce_cap = \"-3N\"\n", "line 2", "above 0"},
           Case{"[device]\nprofile = \"touch\"\nforce_cap = \"5N\"\n", "line 3", "at most 3.3 N"},
           Case{"[tool]\nprobe = \"ball\"\n", "line 2", "sphere:RADIUS"},
           Case{"[workspace]\npose = [1, 2]\n", "line 2", "three or seven numbers"},
           Case{"[workspace]\npose = [1, 2, \"3mm\"]\n", "line 2", "no finite number"},
           Case{"[workspace]\npose = [1, 2, inf]\n", "line 2", "no finite number"},
           Case{"[workspace]\npose = [true, 2, 3]\n", "line 2", "no finite number"},
           Case{"[workspace]\npose = [0, 0, 0, 2, 0, 0, 0]\n", "line 2", "unit length"},
           Case{"[workspace]\npose = \"here\"\n", "line 2", "in metres"},
           Case{"[workspace]\nscale = 0\n", "line 2", "above 0"},
           Case{"[workspace]\nscale = nan\n", "line 2", "above 0"},
           Case{"[workspace]\nscale = \"2\"\n", "line 2", "above 0"},
           Case{"[workspace]\nscale = true\n", "line 2", "above 0"},
           Case{"[[object]]\nmesh = \"a.obj\"\nstiffness = \"0N/mm\"\n", "line 3", "above 0"},
           Case{"[[object]\n", "line 1", "not TOML"},
           Case{"[tool]\nprobe = \"point\"\nprobe = \"point\"\n", "line 3", "not TOML"},
       }) {
    INFO(wrong.text);
    const auto scene = read(wrong.text);
    REQUIRE(!scene);
    INFO(scene.error().message);
    CHECK(scene.error().code == ExitCode::invalid_input);
    CHECK(scene.error().message.find("scene.toml: ") != std::string::npos);
    CHECK(scene.error().message.find(wrong.place) != std::string::npos);
    CHECK(scene.error().message.find(wrong.cause) != std::string::npos);
  }
}

TEST_CASE("A missing scene and a folder are file errors") {
  const TemporaryFolder folder;
  for (const std::string& path : {folder.path("missing.toml"), folder.folder()}) {
    const auto scene = read_scene(path);
    REQUIRE(!scene);
    CHECK(scene.error().code == ExitCode::file_or_device);
    CHECK(scene.error().message.find(path) == 0);
  }
}

TEST_CASE("A scene is read the same in a locale with decimal commas") {
  const char* set = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const auto scene = read("[[object]]\nmesh = \"a.obj\"\nscale = 1.5\nstiffness = \"1.5N/mm\"\n");
  std::setlocale(LC_ALL, "C");
  if (set == nullptr) WARN("the locale de_DE.UTF-8 is not installed; checked in the C locale");
  REQUIRE(scene);
  CHECK(scene->objects[0].placement.scale == 1.5);
  CHECK(scene->objects[0].stiffness == 1500);
}

TEST_CASE("The profiles have the figures of their devices, and low is the worst of them") {
  REQUIRE(find_device_profile("falcon")->force_cap == 8);
  REQUIRE(find_device_profile("touch")->encoder_step == Approx(55e-6));
  REQUIRE(find_device_profile("touch")->stiffness_cap == 400);
  REQUIRE(find_device_profile("omega3")->workspace[2] == Approx(0.11));
  REQUIRE(find_device_profile("wooden") != nullptr);
  REQUIRE(find_device_profile("") == nullptr);
  REQUIRE(device_profile_names() == " low falcon touch omega3 wooden");
  const DeviceProfile& low = *find_device_profile("low");
  for (const DeviceProfile& profile : device_profiles) {
    CHECK(low.force_cap >= profile.force_cap);
    CHECK(low.stiffness_cap >= profile.stiffness_cap);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CHECK(low.workspace[axis] >= profile.workspace[axis]);
    }
  }
}
