// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene.hpp"

#include <catch2/catch.hpp>
#include <clocale>
#include <cmath>

#include "tests/formats/scene/scene_text.hpp"
#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/skip.hpp"

namespace scene_test {

namespace {

using namespace spm;
using namespace spm::test;

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
movable = true
open = "sheet"

[[object]]
asset = "spot.spm.exr"
)");
  const auto scene = read_scene(folder.path("scene.toml"));
  REQUIRE(scene);
  CHECK(scene->objects[0].movable);
  CHECK(scene->objects[0].open == OpenAs::sheet);
  CHECK_FALSE(scene->objects[1].open);
  CHECK_FALSE(scene->objects[1].movable);
  CHECK(scene->device.driver == "falcon");
  CHECK(scene->device.profile == find_device_profile("falcon"));
  CHECK(scene->device.force_cap == 6.0);
  CHECK(scene->probe == ProbeShape{ProbeKind::ball, 5e-4, 0});
  CHECK_FALSE(scene->probe_form);
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
  const auto scene = scene_of_text("[[object]]\nmesh = \"a.obj\"\n");
  REQUIRE(scene);
  CHECK(scene->device.driver.empty());
  CHECK(scene->device.profile == nullptr);
  CHECK_FALSE(scene->device.force_cap);
  CHECK_FALSE(scene->probe);
  CHECK(scene->workspace.position == Vector3::Zero());
  CHECK(scene->workspace.scale == 1);
  CHECK(scene->objects[0].stiffness == 1000);
  CHECK_FALSE(scene->objects[0].stiffness_given);
  CHECK(scene->objects[0].placement.scale == 1);
  const auto point = scene_of_text("tool.probe = \"point\"\n[[object]]\nmesh = \"a.obj\"\n");
  REQUIRE(point);
  CHECK(point->probe == ProbeShape{});
}

TEST_CASE("A tool may be a capsule, and says what the paper's force is the mean over") {
  const auto scene = scene_of_text(
      "[tool]\nprobe = \"capsule:0.5mm,8mm\"\npaper_probe = \"volume\"\n"
      "[[object]]\nmesh = \"a.obj\"\n");
  REQUIRE(scene);
  CHECK(scene->probe == ProbeShape{ProbeKind::capsule, 0.5e-3, 8e-3});
  CHECK(scene->probe_form == PaperProbeForm::volume);
}

TEST_CASE("An object's effects become SI: friction, damping, texture and smoothing") {
  const auto scene = scene_of_text(R"(
[[object]]
asset = "a.spm.exr"
method = "proxy"
stiffness = "1.5N/mm"
friction = { stick = 0.5, slide = 0.4, stiffness = "2N/mm" }
damping = "1N s/m"
texture = { amplitude = "0.05mm", wavelength = "1mm", seed = 7 }

[[object]]
asset = "b.spm.exr"
stiffness = "0.8N/mm"
friction = { slide = 0.3 }
smoothing = { sigma = "0.2mm", samples = 9 }
turn_limit = "90rad/s"

[object.texture]
amplitude = "10um"
wavelength = "0.5mm"

[[object]]
asset = "c.spm.exr"
method = "paper"
paper_rule = "all-planes"
density = 1.5
friction = { force = "300mN", depth_gain = "0.1/mm" }
texture = { noise = "10um", seed = 3 }
)");
  REQUIRE(scene);
  const EffectSettings& first = scene->objects[0].effects;
  CHECK(scene->objects[0].method == Method::proxy);
  CHECK(first.friction.stick == 0.5);
  CHECK(first.friction.slide == 0.4);
  CHECK(first.friction.stiffness == 2000);
  CHECK(first.damping == 1);
  CHECK(first.texture.amplitude == Approx(50e-6));
  CHECK(first.texture.wavelength == Approx(1e-3));
  CHECK(first.texture.seed == 7);
  CHECK(first.smoothing.sigma == 0);
  const EffectSettings& second = scene->objects[1].effects;
  CHECK(scene->objects[1].method == std::nullopt);
  CHECK(second.friction.stick == 0.3);
  CHECK(second.friction.slide == 0.3);
  CHECK(second.friction.stiffness == Approx(800));
  CHECK(second.smoothing.sigma == Approx(2e-4));
  CHECK(second.smoothing.samples == 9);
  CHECK(second.texture.amplitude == Approx(1e-5));
  CHECK(second.damping == 0);
  CHECK(first.turn.rate == default_turn_rate);
  CHECK(second.turn.rate == 90);
  const EffectSettings& third = scene->objects[2].effects;
  CHECK(scene->objects[2].method == Method::paper);
  CHECK(scene->objects[2].rule == PaperRule::all_planes);
  CHECK(scene->objects[1].density == 1);
  CHECK(scene->objects[2].density == 1.5);
  CHECK(third.friction_force == Approx(0.3));
  CHECK(third.friction_depth == Approx(100));
  CHECK(third.texture_noise == Approx(1e-5));
  CHECK(third.noise_seed == 3);
}

TEST_CASE("Without their keys there are no effects, and 0 turns one off") {
  const auto none = scene_of_text("[[object]]\nasset = \"a\"\n");
  REQUIRE(none);
  CHECK_FALSE(none->objects[0].effects.any());
  CHECK(none->objects[0].effects.smoothing.sigma == 0);
  const auto off = scene_of_text(
      "[[object]]\nasset = \"a\"\nfriction = { slide = 0 }\ndamping = \"0Ns/m\"\n"
      "texture = { amplitude = \"0mm\", wavelength = \"1mm\" }\nsmoothing = { sigma = \"0um\" }\n");
  REQUIRE(off);
  CHECK_FALSE(off->objects[0].effects.any());
  CHECK(off->objects[0].effects.smoothing.sigma == 0);
}

TEST_CASE("What is wrong in an object's effects is told by its line, cause and cure") {
  struct Case {
    const char* key;
    const char* cause;
  };
  for (const Case& wrong : {
           Case{"friction = 0.5", "must be a table, such as { stick"},
           Case{"friction = {}", "needs 'slide'"},
           Case{"friction = { stiffness = \"2N/mm\" }", "needs 'slide'"},
           Case{"friction = { slide = -0.1 }", "from 0 to 10"},
           Case{"friction = { slide = nan }", "from 0 to 10"},
           Case{"friction = { slide = 11 }", "from 0 to 10"},
           Case{"friction = { slide = \"0.4\" }", "from 0 to 10"},
           Case{"friction = { slide = true }", "from 0 to 10"},
           Case{"friction = { stick = 0.2, slide = 0.4 }", "less than 'slide'"},
           Case{"friction = { slide = 0.4, stiffness = 2 }", "\"2N/mm\""},
           Case{"friction = { slide = 0.4, stiffness = \"0N/mm\" }", "above 0"},
           Case{"friction = { slid = 0.4 }", "did you mean 'slide'?"},
           Case{"friction = { mu = 0.4 }", "its keys are stick slide stiffness force depth_gain"},
           Case{"friction = { force = \"1N\", slide = 0.4 }", "one kind"},
           Case{"friction = { depth_gain = \"1/m\" }", "needs 'force'"},
           Case{"friction = { force = \"-1N\" }", "0 or more"},
           Case{"friction = { force = \"1N\", depth_gain = \"1m\" }", "/m or /mm"},
           Case{"damping = 2", "\"2Ns/m\""},
           Case{"damping = \"2N/m\"", "Ns/m"},
           Case{"turn_limit = 120", "\"120rad/s\""},
           Case{"movable = \"yes\"", "true or false"},
           Case{"open = \"box\"", "auto solid sheet"},
           Case{"turn_limit = \"-1rad/s\"", "0 or more"},
           Case{"damping = \"-2Ns/m\"", "0 or more"},
           Case{"texture = \"rough\"", "must be a table"},
           Case{"texture = { amplitude = \"1um\" }", "needs 'amplitude' and 'wavelength'"},
           Case{"texture = { amplitude = \"-1um\", wavelength = \"1mm\" }", "0 or more"},
           Case{"texture = { amplitude = \"1um\", wavelength = \"0mm\" }", "above 0"},
           Case{"texture = { amplitude = \"1um\", wavelength = \"1mm\", seed = -1 }",
                "whole number"},
           Case{"texture = { amplitude = \"1um\", wavelength = \"1mm\", seed = 1.5 }",
                "whole number"},
           Case{"texture = { noise = \"1um\", wavelength = \"1mm\" }", "one kind"},
           Case{"smoothing = { samples = 3 }", "needs 'sigma'"},
           Case{"smoothing = { sigma = \"1mm\", samples = 0 }", "from 1 to 64"},
           Case{"smoothing = { sigma = \"1mm\", samples = 65 }", "from 1 to 64"},
           Case{"smoothing = { sigma = 1e-3 }", "\"0.2mm\""},
           Case{"method = \"voxels\"", "it can be spm proxy paper"},
           Case{"method = 3", "must be text"},
           Case{"density = -1", "0 to 1000"},
           Case{"paper_rule = \"best\"", "closest-plane closest-surface all-planes partition"},
           Case{"scale = -1", "mirrored"},
           Case{"scale = 1e7", "from 1e-6 to 1e6"},
           Case{"scale = 1e-7", "from 1e-6 to 1e6"},
           Case{"pose = [0, 0, 0, 1.02, 0, 0, 0]", "1 %"},
       }) {
    INFO(wrong.key);
    const auto scene =
        scene_of_text("[[object]]\nasset = \"a.spm.exr\"\n" + std::string(wrong.key) + "\n");
    REQUIRE(!scene);
    INFO(scene.error().message);
    CHECK(scene.error().code == ExitCode::invalid_input);
    CHECK(scene.error().message.find("scene.toml: line 3: ") != std::string::npos);
    CHECK(scene.error().message.find(wrong.cause) != std::string::npos);
  }
}

TEST_CASE("Friction of which only rest or only motion is given is the same in both") {
  for (const char* given : {"stick = 0.5", "slide = 0.5"}) {
    const auto scene =
        scene_of_text("[[object]]\nasset = \"a\"\nfriction = { " + std::string(given) + " }\n");
    REQUIRE(scene);
    CHECK(scene->objects[0].effects.friction.stick == 0.5);
    CHECK(scene->objects[0].effects.friction.slide == 0.5);
  }
}

TEST_CASE("A quaternion that is off unit length by more than 1 % is refused, by less made one") {
  const auto with = [](double length) {
    return scene_of_text("[[object]]\nasset = \"a\"\npose = [0, 0, 0, " + std::to_string(length) +
                         ", 0, 0, 0]\n");
  };
  for (const double length : {0.9905, 1.0095}) {
    const auto scene = with(length);
    REQUIRE(scene);
    CHECK(scene->objects[0].placement.rotation.norm() == Approx(1).epsilon(1e-12));
  }
  for (const double length : {0.985, 1.015}) CHECK_FALSE(with(length));
}

TEST_CASE("A quaternion within 1 % of unit length is made one, and a scene of nothing is refused") {
  const auto scene =
      scene_of_text("[[object]]\nasset = \"a\"\npose = [0, 0, 0, 0.704, 0, 0.704, 0]\n");
  REQUIRE(scene);
  CHECK(std::abs(scene->objects[0].placement.rotation.norm() - 1) < 1e-12);
  const auto empty = scene_of_text("object = []\n");
  REQUIRE(!empty);
  CHECK(empty.error().code == ExitCode::invalid_input);
  CHECK(empty.error().message.find("needs an object") != std::string::npos);
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
           Case{"[physics]\n", "line 1", "its keys are device tool workspace stabilization object"},
           Case{"device = \"sim\"\n", "line 1", "write [device]"},
           Case{"[device]\nprofile = \"falcn\"\n", "line 2", "low falcon touch omega3 wooden"},
           Case{"[device]\nforce_cap = 3\n", "line 2", "\"3N\""},
           Case{"[device]\nforce_cap = \"3\"\n", "line 2", "unit"},
           Case{"[device]\nforce_cap = \"3mm\"\n", "line 2", "unknown unit"},
           Case{"[device]\nforce_cap = \"-3N\"\n", "line 2", "above 0"},
           Case{"[device]\nprofile = \"touch\"\nforce_cap = \"5N\"\n", "line 3", "at most 3.3 N"},
           Case{"[tool]\nprobe = \"ball\"\n", "line 2", "sphere:RADIUS"},
           Case{"[tool]\nprobe = \"capsule:1mm\"\n", "line 2", "capsule:RADIUS,LENGTH"},
           Case{"[tool]\nprobe = \"capsule:-1mm,5mm\"\n", "line 2", "not above 0"},
           Case{"[tool]\npaper_probe = \"skin\"\n", "line 2", "it can be surface volume"},
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
    const auto scene = scene_of_text(wrong.text);
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
  const auto scene =
      scene_of_text("[[object]]\nmesh = \"a.obj\"\nscale = 1.5\nstiffness = \"1.5N/mm\"\n");
  std::setlocale(LC_ALL, "C");
  if (set == nullptr) SPM_SKIP("the locale de_DE.UTF-8 is not there");
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

}  // namespace scene_test
