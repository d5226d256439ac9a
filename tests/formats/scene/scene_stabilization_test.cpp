// SPDX-License-Identifier: Apache-2.0
// A scene's stabilizers, and the stiffness that is left to its device.
#include <catch2/catch.hpp>

#include "common/contact/stable_stiffness.hpp"
#include "formats/scene/scene.hpp"
#include "tests/formats/scene/scene_text.hpp"

namespace scene_stabilization_test {

namespace {

using namespace spm;
using namespace spm::test;

}  // namespace

TEST_CASE("A scene's stabilizers become SI, and are off without their table") {
  const auto none = scene_of_text("[device]\nprofile = \"touch\"\n[[object]]\nasset = \"a\"\n");
  REQUIRE(none);
  CHECK_FALSE(none->stabilization.any());
  const auto scene = scene_of_text(R"(
[device]
profile = "touch"
[stabilization]
damping = 0.5
delay = 2
coupling = "3N/mm"
coupling_damping = "1Ns/m"
passivity = true
velocity = "difference"
potential = "0.2mm"
[[object]]
asset = "a"
)");
  REQUIRE(scene);
  StabilizationSettings wanted;
  wanted.damping_share = 0.5;
  wanted.delay_ticks = 2;
  wanted.coupling = 3000;
  wanted.coupling_damping = 1;
  wanted.passivity = true;
  wanted.velocity = VelocityMethod::difference;
  wanted.potential = scene->stabilization.potential;
  wanted.device_mass = find_device_profile("touch")->moving_mass;
  wanted.lag = find_device_profile("touch")->actuator_lag();
  CHECK(scene->stabilization == wanted);
  CHECK(scene->stabilization.potential == Approx(2e-4));
  const auto recommended =
      scene_of_text("[stabilization]\nrecommended = true\n[[object]]\nasset = \"a\"\n");
  REQUIRE(recommended);
  CHECK(recommended->stabilization == recommended_stabilization);
  const auto without = scene_of_text(
      "[stabilization]\nrecommended = true\ndamping = 0\n[[object]]\nasset = \"a\"\n");
  REQUIRE(without);
  CHECK(without->stabilization.damping_share == 0);
}

TEST_CASE("What is wrong in a scene's cures is told by its line, cause and cure") {
  struct Case {
    const char* key;
    const char* cause;
  };
  for (const Case& wrong : {
           Case{"dampng = 0.8", "did you mean 'damping'?"},
           Case{"magic = 1", "its keys are recommended damping delay coupling"},
           Case{"recommended = 1", "true or false"},
           Case{"damping = \"1Ns/m\"", "from 0 to 2"},
           Case{"damping = -0.1", "from 0 to 2"},
           Case{"damping = nan", "from 0 to 2"},
           Case{"damping = 2.1", "from 0 to 2"},
           Case{"delay = 9", "from 0 to 8"},
           Case{"delay = -1", "from 0 to 8"},
           Case{"coupling = 3", "\"2N/mm\""},
           Case{"coupling = \"-3N/mm\"", "0 or more"},
           Case{"coupling = \"3N\"", "unknown unit"},
           Case{"coupling_damping = \"1Ns/m\"", "give 'coupling'"},
           Case{"passivity = \"yes\"", "true or false"},
           Case{"velocity = \"guess\"", "it can be estimate difference"},
           Case{"potential = 0.1", "\"0.1mm\""},
           Case{"potential = \"-1mm\"", "0 or more"},
       }) {
    INFO(wrong.key);
    const auto scene = scene_of_text("[stabilization]\n" + std::string(wrong.key) +
                                     "\n[[object]]\nasset = \"a.spm.exr\"\n");
    REQUIRE(!scene);
    INFO(scene.error().message);
    CHECK(scene.error().code == ExitCode::invalid_input);
    CHECK(scene.error().message.find("scene.toml: line 2: ") != std::string::npos);
    CHECK(scene.error().message.find(wrong.cause) != std::string::npos);
  }
}

TEST_CASE("A stiffness may be left to the device, and is the same at the hand by any workspace") {
  const std::string touch = "[device]\nprofile = \"touch\"\n";
  const std::string object = "[[object]]\nasset = \"a\"\nstiffness = \"auto\"\n";
  const auto scene = scene_of_text(touch + object + "friction = { slide = 0.3 }\n");
  REQUIRE(scene);
  CHECK(scene->objects[0].stiffness == stable_stiffness(*find_device_profile("touch")));
  CHECK(scene->objects[0].stiffness_chosen);
  CHECK(scene->objects[0].stiffness_given);
  CHECK(scene->objects[0].effects.friction.stiffness == scene->objects[0].stiffness);
  const auto scaled = scene_of_text("[workspace]\nscale = 4\n" + touch + object);
  REQUIRE(scaled);
  CHECK(scaled->objects[0].stiffness == Approx(scene->objects[0].stiffness / 4));
  const auto nobody = scene_of_text(object);
  REQUIRE(!nobody);
  CHECK(nobody.error().message.find("line 3: ") != std::string::npos);
  CHECK(nobody.error().message.find("add 'profile' to [device], one of low falcon") !=
        std::string::npos);
}

}  // namespace scene_stabilization_test
