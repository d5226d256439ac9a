// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/force_choice.hpp"

#include <catch2/catch.hpp>

#include "common/contact/stable_stiffness.hpp"
#include "tests/servo/support/chosen_scene.hpp"

namespace force_choice_test {

using namespace spm;
using namespace spm::servo;
using test::choose;

TEST_CASE("An asset alone is a scene of one object in the hand's frame") {
  ForceOptions options;
  options.asset = "duck.spm.exr";
  options.stiffness = 500;
  const auto choice = choose_forces(options);
  REQUIRE(choice);
  REQUIRE(choice->assets == std::vector<std::string>{"duck.spm.exr"});
  REQUIRE(choice->scene.objects.size() == 1);
  REQUIRE(choice->scene.objects[0].force.stiffness == 500);
  REQUIRE(choice->scene.objects[0].force.method == Method::proxy);
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
}

TEST_CASE("A workspace so small that no stiffness suits is refused by its own key, with the cure") {
  const std::string text = "[device]\nprofile = \"touch\"\n[workspace]\nscale = 1e-6\n[[object]]\n";
  const auto refused = choose(text + "asset = \"a\"\n");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ExitCode::invalid_input);
  CHECK(refused.error().message.find("'scale' of [workspace] is 1e-06") != std::string::npos);
  CHECK(refused.error().message.find("give a scale of at least") != std::string::npos);
  CHECK(choose(text + "asset = \"a\"\nstiffness = \"1N/mm\"\n"));
}

TEST_CASE("What is not named is the default, for the device that is served") {
  const DeviceProfile& falcon = *find_device_profile("falcon");
  ForceOptions options;
  options.asset = "duck.spm.exr";
  options.device = ForceDevice{&falcon, falcon.stiffness_cap};
  const auto choice = choose_forces(options);
  REQUIRE(choice);
  const ForceSettings& force = choice->scene.objects[0].force;
  CHECK(force.method == Method::proxy);
  CHECK(force.stiffness == stable_stiffness(falcon));
  CHECK(choice->scene.stabilization == in_loop_of(falcon, recommended_stabilization));
  CHECK(choice->scene.added.force.method == Method::proxy);
  CHECK(choice->scene.added.force.stiffness == stable_stiffness(falcon));
  // The device that is there counts, and not the one that the scene was made for.
  const auto scene = choose("[device]\nprofile = \"touch\"\n[[object]]\nasset = \"a\"\n", [&] {
    ForceOptions of_device;
    of_device.device = options.device;
    return of_device;
  }());
  REQUIRE(scene);
  CHECK(scene->scene.objects[0].force.stiffness == stable_stiffness(falcon));
  CHECK(scene->scene.stabilization == in_loop_of(falcon, recommended_stabilization));
}

TEST_CASE("A device of no known kind gets what the worst one holds, and never beyond its cap") {
  CHECK(auto_stiffness({}) == stable_stiffness(*find_device_profile("low")));
  CHECK(auto_stiffness({nullptr, 400}) == 400);
  ForceOptions options;
  options.asset = "duck.spm.exr";
  const auto none = choose_forces(options);
  REQUIRE(none);
  CHECK(none->scene.objects[0].force.stiffness == 1000);
}

TEST_CASE("A method other than the default, named without a scene, is bare") {
  for (const Method method : {Method::spm, Method::paper, Method::proxy}) {
    ForceOptions options;
    options.asset = "duck.spm.exr";
    options.method = method;
    options.device = ForceDevice{};
    const auto choice = choose_forces(options);
    REQUIRE(choice);
    CHECK(choice->scene.objects[0].force.method == method);
    CHECK(choice->scene.stabilization.any() == (method == Method::proxy));
    options.stabilization = recommended_stabilization;
    CHECK(choose_forces(options)->scene.stabilization.any());
  }
}

TEST_CASE("Settings that one method alone has name it too") {
  const auto choice = choose(
      "[[object]]\nasset = \"a\"\nsmoothing = { sigma = \"0.1mm\" }\n[[object]]\nasset = \"b\"\n");
  REQUIRE(choice);
  CHECK(choice->scene.objects[0].force.method == Method::spm);
  CHECK(choice->scene.objects[1].force.method == Method::proxy);
  const auto lattice =
      choose("[stabilization]\npotential = \"0.1mm\"\n[[object]]\nasset = \"a\"\n");
  REQUIRE(lattice);
  CHECK(lattice->scene.objects[0].force.method == Method::spm);
}

TEST_CASE("A scene's stabilizers come to the loop, and an asset alone has the default's") {
  const auto choice = choose("[stabilization]\ndamping = 0.8\n[[object]]\nasset = \"a\"\n");
  REQUIRE(choice);
  CHECK(choice->scene.stabilization.damping_share == 0.8);
  ForceOptions options;
  options.asset = "duck.spm.exr";
  const auto alone = choose_forces(options);
  REQUIRE(alone);
  CHECK(alone->scene.stabilization == recommended_stabilization);
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
  options.probe = ProbeShape{ProbeKind::ball, 2e-4, 0};
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
           Case{"asset = \"a\"\ndensity = 2", "method paper alone"},
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
}

TEST_CASE("A probe that a method does not know is refused with the object's line and the cure") {
  struct Case {
    const char *tool, *object;
    std::vector<std::string> words;
  };
  for (const Case& wrong : {
           Case{"probe = \"capsule:1mm,5mm\"",
                "method = \"spm\"",
                {"method spm knows no probe but a point and a sphere", "--form full",
                 "sphere:1 mm"}},
           Case{"probe = \"capsule:1mm,5mm\"", "", {"method proxy knows no probe"}},
           Case{"probe = \"sphere:1mm\"",
                "method = \"paper\"\npaper_rule = \"all-planes\"",
                {"rule all-planes is for a point", "take closest-plane"}},
           Case{"paper_probe = \"volume\"", "method = \"paper\"", {"a point has no volume"}},
       }) {
    const auto choice = choose(std::string("[tool]\n") + wrong.tool +
                               "\n[[object]]\nasset = \"a\"\n" + wrong.object + "\n");
    REQUIRE_FALSE(choice);
    INFO(choice.error().message);
    CHECK(choice.error().code == ExitCode::invalid_input);
    CHECK(choice.error().message.find("scene.toml: line 3: ") != std::string::npos);
    for (const std::string& word : wrong.words) {
      CHECK(choice.error().message.find(word) != std::string::npos);
    }
  }
}

TEST_CASE("A tool's form holds for every object, and for what applications add") {
  ForceOptions options;
  options.probe_form = PaperProbeForm::volume;
  const auto choice = choose(
      "[tool]\nprobe = \"capsule:0.1mm,5mm\"\npaper_probe = \"surface\"\n"
      "[[object]]\nasset = \"a\"\nmethod = \"paper\"\n"
      "[[object]]\nasset = \"b\"\nmethod = \"paper\"\n",
      options);
  REQUIRE(choice);
  for (const ForceSettings& force : {choice->scene.objects[0].force, choice->scene.objects[1].force,
                                     choice->scene.added.force}) {
    CHECK(force.method == Method::paper);
    CHECK(force.form == PaperProbeForm::volume);
    CHECK(force.probe() == ProbeShape{ProbeKind::capsule, 1e-4, 5e-3});
    CHECK(force.probe_axis == Vector3::UnitZ());
  }
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

TEST_CASE("A capsule with spm or proxy is a usage error, a ball or capsule by the paper is none") {
  ForceSettings settings;
  settings.take_probe({ProbeKind::capsule, 1e-3, 5e-3});
  for (const Method method : {Method::spm, Method::proxy}) {
    settings.method = method;
    const auto checked = check_settings(settings);
    REQUIRE_FALSE(checked);
    CHECK(checked.error().code == ExitCode::usage);
  }
  settings.method = Method::paper;
  CHECK(check_settings(settings));
  settings.take_probe({ProbeKind::ball, 1e-3, 0});
  CHECK(check_settings(settings));
}

TEST_CASE("Of a capsule the radius must be one that the asset was baked for, also of a full one") {
  AssetMetadata asset;
  asset.form = AssetForm::full;
  asset.probe_radius = 0.5e-3;
  ForceSettings settings;
  settings.method = Method::paper;
  settings.take_probe({ProbeKind::capsule, 0.5e-3, 20e-3});
  CHECK(check_asset(asset, settings, "a"));
  CHECK_FALSE(check_asset(asset, settings, "a", 0.5));
  settings.probe_radius = 0.6e-3;
  const auto checked = check_asset(asset, settings, "a");
  REQUIRE_FALSE(checked);
  CHECK(checked.error().code == ExitCode::invalid_input);
  CHECK(checked.error().message ==
        "a: was baked for probe sphere:500 um, whose radius is smaller than that of capsule:600 "
        "um,20 mm; bake the mesh again with --probe and the larger radius");
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
