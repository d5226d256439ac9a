// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/force_choice.hpp"

#include <catch2/catch.hpp>
#include <fstream>

#include "common/contact/stable_stiffness.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace force_choice_test {

using namespace spm;
using namespace spm::servo;

namespace {

Result<ForceChoice> choose(const std::string& text, ForceOptions options = {}) {
  const test::TemporaryFolder folder;
  options.scene = folder.file("scene.toml");
  std::ofstream(options.scene) << text;
  return choose_forces(options);
}

}  // namespace

TEST_CASE("An asset alone is a scene of one object in the hand's frame") {
  ForceOptions options;
  options.asset = "duck.spm.exr";
  options.stiffness = 500;
  const auto choice = choose_forces(options);
  REQUIRE(choice);
  REQUIRE(choice->assets == std::vector<std::string>{"duck.spm.exr"});
  REQUIRE(choice->scene.objects.size() == 1);
  REQUIRE(choice->scene.objects[0].force.stiffness == 500);
  REQUIRE(choice->scene.objects[0].force.method == Method::spm);
  REQUIRE(choice->scene.objects[0].placement.scale == 1);
  REQUIRE_FALSE(choice->scene.objects[0].effects.any());
}

TEST_CASE("A stiffness may be left to the device that the scene names, for every object") {
  const std::string objects =
      "[[object]]\nasset = \"a\"\nstiffness = \"9N/mm\"\n[[object]]\nasset = \"a\"\n";
  ForceOptions options;
  options.stiffness_chosen = true;
  const auto choice =
      choose("[device]\nprofile = \"touch\"\n[workspace]\nscale = 2\n" + objects, options);
  REQUIRE(choice);
  for (const PlacedObject& object : choice->scene.objects) {
    CHECK(object.force.stiffness == stable_stiffness(*find_device_profile("touch")) / 2);
  }
  const auto nobody = choose(objects, options);
  REQUIRE_FALSE(nobody);
  CHECK(nobody.error().code == ExitCode::usage);
  CHECK(nobody.error().message.find("'profile'") != std::string::npos);
  options.asset = "duck.spm.exr";
  const auto alone = choose_forces(options);
  REQUIRE_FALSE(alone);
  CHECK(alone.error().code == ExitCode::usage);
}

TEST_CASE("A scene's stabilizers come to the loop, and an asset alone has none") {
  const auto choice = choose("[stabilization]\ndamping = 0.8\n[[object]]\nasset = \"a\"\n");
  REQUIRE(choice);
  CHECK(choice->scene.stabilization.damping_share == 0.8);
  ForceOptions options;
  options.asset = "duck.spm.exr";
  const auto alone = choose_forces(options);
  REQUIRE(alone);
  CHECK_FALSE(alone->scene.stabilization.any());
}

TEST_CASE("Neither or both of asset and scene is a usage error") {
  ForceOptions options;
  REQUIRE(choose_forces(options).error().code == ExitCode::usage);
  options.asset = "duck.spm.exr";
  options.scene = "scene.toml";
  REQUIRE(choose_forces(options).error().code == ExitCode::usage);
}

TEST_CASE("Objects of a scene that name the same file share an asset") {
  const auto choice = choose(
      "[tool]\nprobe = \"sphere:0.1mm\"\n[[object]]\nasset = \"a\"\n[[object]]\nasset = \"b\"\n"
      "[[object]]\nasset = \"x/../a\"\nscale = 2\ndamping = \"1Ns/m\"\n");
  REQUIRE(choice);
  REQUIRE(choice->assets.size() == 2);
  REQUIRE(choice->scene.objects[0].asset == 0);
  REQUIRE(choice->scene.objects[1].asset == 1);
  REQUIRE(choice->scene.objects[2].asset == 0);
  REQUIRE(choice->scene.objects[2].placement.scale == 2);
  REQUIRE(choice->scene.objects[2].effects.damping == 1);
  REQUIRE(choice->scene.objects[1].force.probe_radius == Approx(1e-4));
}

TEST_CASE("What the command line gives wins over what a scene says, for every object") {
  ForceOptions options;
  options.method = Method::proxy;
  options.stiffness = 700;
  options.probe_radius = 2e-4;
  const auto choice = choose(
      "[tool]\nprobe = \"sphere:0.1mm\"\n[[object]]\nasset = \"a\"\nstiffness = \"2N/mm\"\n"
      "[[object]]\nasset = \"b\"\n",
      options);
  REQUIRE(choice);
  for (const PlacedObject& object : choice->scene.objects) {
    REQUIRE(object.force.method == Method::proxy);
    REQUIRE(object.force.stiffness == 700);
    REQUIRE(object.force.probe_radius == 2e-4);
  }
}

TEST_CASE("A scene that cannot be felt exits 3 with the line of its object and the cure") {
  struct Case {
    const char* text;
    const char* cause;
  };
  for (const Case& wrong : {
           Case{"mesh = \"a.obj\"", "has no 'asset'"},
           Case{"asset = \"a\"\nstiffness = \"2000N/mm\"", "out of range"},
           Case{"asset = \"a\"\nmethod = \"paper\"\nfriction = { slide = 0.4 }", "'depth_gain'"},
           Case{"asset = \"a\"\nmethod = \"paper\"\n"
                "texture = { amplitude = \"1um\", wavelength = \"1mm\" }",
                "'noise'"},
           Case{"asset = \"a\"\nfriction = { force = \"1N\" }", "method paper alone"},
           Case{"asset = \"a\"\ntexture = { noise = \"1um\" }", "method paper alone"},
           Case{"asset = \"a\"\nmethod = \"proxy\"\nsmoothing = { sigma = \"1mm\" }",
                "method spm alone"},
       }) {
    INFO(wrong.text);
    const auto choice =
        choose(std::string("[[object]]\nasset = \"b\"\n[[object]]\n").append(wrong.text));
    REQUIRE_FALSE(choice);
    INFO(choice.error().message);
    REQUIRE(choice.error().code == ExitCode::invalid_input);
    REQUIRE(choice.error().message.find("scene.toml: line 3: ") != std::string::npos);
    REQUIRE(choice.error().message.find(wrong.cause) != std::string::npos);
  }
  const auto ball =
      choose("[tool]\nprobe = \"sphere:1mm\"\n[[object]]\nasset = \"a\"\nmethod = \"paper\"\n");
  REQUIRE_FALSE(ball);
  REQUIRE(ball.error().code == ExitCode::invalid_input);
  REQUIRE(ball.error().message.find("point probe") != std::string::npos);
}

TEST_CASE("A probe must fit the asset at the object's scale, and the scene's line is told") {
  AssetMetadata asset;
  asset.probe_radius = 0.5e-3;
  const auto choice = choose(
      "[tool]\nprobe = \"sphere:0.8mm\"\n[[object]]\nasset = \"a\"\nscale = 2\n"
      "[[object]]\nasset = \"b\"\n");
  REQUIRE(choice);
  REQUIRE(check_asset(asset, *choice, 0));
  const auto refused = check_asset(asset, *choice, 1);
  REQUIRE_FALSE(refused);
  REQUIRE(refused.error().code == ExitCode::invalid_input);
  REQUIRE(refused.error().message.find("scene.toml: line 6: ") != std::string::npos);
}

TEST_CASE("The paper's method with a ball is a usage error") {
  ForceSettings settings;
  settings.method = Method::paper;
  settings.probe_radius = 1e-3;
  const auto checked = check_settings(settings);
  REQUIRE_FALSE(checked);
  REQUIRE(checked.error().code == ExitCode::usage);
}

TEST_CASE("A stiffness that is no such thing is a usage error") {
  for (const double stiffness : {-1.0, 1e9, std::nan("")}) {
    ForceSettings settings;
    settings.stiffness = stiffness;
    REQUIRE(check_settings(settings).error().code == ExitCode::usage);
  }
}

TEST_CASE("The paper's method on a sparse asset exits 3 and names the cure") {
  ForceSettings settings;
  settings.method = Method::paper;
  AssetMetadata asset;
  const auto checked = check_asset(asset, settings, "duck.spm.exr");
  REQUIRE_FALSE(checked);
  REQUIRE(checked.error().code == ExitCode::invalid_input);
  REQUIRE(checked.error().message.find("--form full") != std::string::npos);
  asset.form = AssetForm::full;
  REQUIRE(check_asset(asset, settings, "duck.spm.exr"));
}

TEST_CASE("A probe larger than the asset's exits 3, one as large passes") {
  ForceSettings settings;
  AssetMetadata asset;
  asset.probe_radius = 0.5e-3;
  settings.probe_radius = 0.5e-3;
  REQUIRE(check_asset(asset, settings, "a"));
  settings.probe_radius = 0.6e-3;
  const auto checked = check_asset(asset, settings, "a");
  REQUIRE_FALSE(checked);
  REQUIRE(checked.error().code == ExitCode::invalid_input);
  REQUIRE(checked.error().message.find("--probe") != std::string::npos);
}

}  // namespace force_choice_test
