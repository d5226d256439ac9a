// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/scene/scene.hpp"
#include "servo/view/view_state.hpp"

namespace view_scene_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr const char* hostile = "<img src=x onerror=alert(1)>\"\\\n\xff";

ViewState state_of_two() {
  ViewState state;
  state.daemon = SPM_CLIENT_RUNNING;
  state.devices.resize(1);
  state.devices[0].name = "sim";
  state.devices[0].state.hand = SPM_CLIENT_HAND_FREE;
  state.assets.resize(2);
  state.assets[0].path = "/models/a \"quoted\".spm.exr";
  state.assets[1].name = hostile;
  state.assets[1].path = "/models/b.spm.exr";
  state.objects.resize(2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    ViewObject& object = state.objects[i];
    object.name = hostile;
    object.state.id = i;
    object.state.asset = i;
    object.state.orientation[0] = 1;
    object.state.scale = 1 + i;
    object.feel.method = SPM_CLIENT_METHOD_PROXY;
    object.feel.stabilized = 1;
    object.feel.stiffness = 812.5 + i;
  }
  state.objects[1].state.position[2] = 0.125;
  state.objects[1].feel.friction_stick = 0.5;
  state.objects[1].feel.friction_slide = 0.4;
  state.objects[1].feel.damping = 2;
  state.objects[1].feel.texture_amplitude = 5e-5;
  state.objects[1].feel.texture_wavelength = 1e-3;
  return state;
}

}  // namespace

TEST_CASE("A saved scene is read again as it was felt") {
  const auto path = std::filesystem::temp_directory_path() / "spm-view-scene-test.toml";
  std::ofstream(path) << scene_toml(state_of_two());
  const auto scene = read_scene(path.string());
  std::filesystem::remove(path);
  if (!scene) FAIL(scene.error().message);
  REQUIRE(scene->objects.size() == 2);
  CHECK(scene->device.driver == "sim:hand=live");
  CHECK(scene->objects[0].asset == "/models/a \"quoted\".spm.exr");
  CHECK(scene->objects[0].stiffness == 812.5);
  const SceneObject& second = scene->objects[1];
  CHECK(second.placement.scale == 2);
  CHECK(second.placement.position.z() == 0.125);
  CHECK(second.effects.friction.stick == 0.5);
  CHECK(second.effects.friction.slide == 0.4);
  CHECK(second.effects.damping == 2);
  CHECK(second.effects.texture.amplitude == Approx(5e-5));
  CHECK(scene->stabilization.any());
}

TEST_CASE("Names of others stay text in the scene that a page gets, whatever their bytes") {
  const auto json = nlohmann::json::parse(scene_json(state_of_two()));
  CHECK(json["objects"][0]["name"] == "<img src=x onerror=alert(1)>\"\\\n\xef\xbf\xbd");
  CHECK(json["objects"][1]["stiffness"] == 813.5);
  CHECK(json["assets"].size() == 2);
}

TEST_CASE("A frame has its parts at the places that the page reads") {
  ViewState state = state_of_two();
  state.devices[0].state.force[1] = 3;
  state.contacts.resize(1);
  state.contacts[0].depth = 0.5;
  state.loop.time_ns = 2'000'000'000;
  state.loop.ticks = 1500;
  spm_client_loop before{};
  before.time_ns = 1'000'000'000;
  before.ticks = 500;
  const auto frame = frame_of(state, before);
  REQUIRE(frame.size() == frame_head + frame_device + 2 * frame_object + frame_contact);
  CHECK(frame[8] == Approx(1000));                                         // rate
  CHECK(frame[frame_head + 12] == 3);                                      // force along y
  CHECK(frame[frame_head + frame_device + frame_object] == 1);             // the second object's id
  CHECK(frame[frame_head + frame_device + 2 * frame_object + 11] == 0.5);  // depth of the contact
}

}  // namespace view_scene_test
