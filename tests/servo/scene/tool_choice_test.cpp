// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/tool_choice.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "servo/scene/force_choice.hpp"
#include "tests/servo/support/chosen_scene.hpp"

namespace tool_choice_test {

using namespace spm;
using namespace spm::servo;
using test::choose;

TEST_CASE("A scene's tool is one of its assets, and its settings come to the loop") {
  const auto choice = choose(
      "[[object]]\nasset = \"a\"\n[tool]\nasset = \"t\"\nscale = 0.5\nspacing = \"1mm\"\n"
      "coupling = \"1N/mm\"\ntorque_cap = \"50mNm\"\nbudget = \"300us\"\n");
  REQUIRE(choice);
  REQUIRE(choice->scene.tool);
  const ToolSettings& tool = *choice->scene.tool;
  REQUIRE(choice->assets.size() == 2);
  CHECK(tool.asset == 1);
  CHECK(choice->assets[1].ends_with("/t"));
  CHECK(tool.placement.scale == 0.5);
  CHECK(tool.spacing == Approx(2e-3));  // of the asset, which the scene halves
  CHECK(tool.coupling == 1000);
  CHECK(tool.turning == 0);
  CHECK(tool.torque_cap == Approx(0.05));
  CHECK(tool.budget == Approx(3e-4));
  CHECK(choice->scene.objects[0].force.probe_radius == 0);
  CHECK(place_of_asset(*choice, 1).ends_with("scene.toml: line 4: "));
  CHECK(choose("[tool]\nasset = \"a\"\n[[object]]\nasset = \"a\"\n")->assets.size() == 1);
}

TEST_CASE("A tool that cannot be one is refused with its line and a cure") {
  AssetMetadata asset;
  asset.closed = true;
  const auto choice = choose("[tool]\nasset = \"t\"\n[[object]]\nasset = \"a\"\n");
  REQUIRE(choice);
  const std::size_t tool = choice->scene.tool->asset;
  CHECK(check_asset(asset, *choice, tool));
  asset.closed = false;
  asset.border_edges = 12;
  const auto open = check_asset(asset, *choice, tool);
  REQUIRE_FALSE(open);
  CHECK(open.error().code == ExitCode::invalid_input);
  CHECK(open.error().message.find("scene.toml: line 2: ") != std::string::npos);
  CHECK(open.error().message.find("12 border edges") != std::string::npos);
  CHECK(check_asset(asset, *choice, choice->scene.objects[0].asset));
  asset.closed = true;
  asset.form = AssetForm::full;
  const auto full = check_asset(asset, *choice, tool);
  REQUIRE_FALSE(full);
  CHECK(full.error().message.find("--form sparse") != std::string::npos);
}

TEST_CASE("A tool without a baked file, a coupling beyond any device and a probe beside are told") {
  const std::string object = "[[object]]\nasset = \"a\"\n";
  const auto unbaked = choose("[tool]\nmesh = \"t.obj\"\n" + object);
  REQUIRE_FALSE(unbaked);
  CHECK(unbaked.error().message.find("spm-bake build") != std::string::npos);
  CHECK(unbaked.error().message.find("scene.toml: line 2: ") != std::string::npos);
  const auto stiff = choose("[tool]\nasset = \"t\"\ncoupling = \"2000N/mm\"\n" + object);
  REQUIRE_FALSE(stiff);
  CHECK(stiff.error().message.find("at most 1000 N/mm") != std::string::npos);
  ForceOptions options;
  options.probe = ProbeShape{ProbeKind::ball, 1e-3, 0};
  const auto probe = choose("[tool]\nasset = \"t\"\n" + object, options);
  REQUIRE_FALSE(probe);
  CHECK(probe.error().code == ExitCode::usage);
}

TEST_CASE("Method paper asks for full objects and a full tool") {
  const auto choice =
      choose("[tool]\nasset = \"t\"\n[[object]]\nasset = \"a\"\nmethod = \"paper\"\n");
  REQUIRE(choice);
  AssetMetadata sparse;
  const auto refused = check_asset(sparse, *choice, 0);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message.find("scene.toml: line 3: ") != std::string::npos);
  CHECK(refused.error().message.find("--form full") != std::string::npos);
  const std::size_t tool = choice->scene.tool->asset;
  sparse.closed = true;
  const auto unread = check_asset(sparse, *choice, tool);
  REQUIRE_FALSE(unread);
  CHECK(unread.error().message.find("--form full") != std::string::npos);
  AssetMetadata full = sparse;
  full.form = AssetForm::full;
  CHECK(check_asset(full, *choice, tool));
  CHECK(check_asset(full, *choice, 0));
}

TEST_CASE("Each device's own tool comes to the loop, and their number must be that of devices") {
  const std::string object = "[[object]]\nasset = \"a\"\n";
  const auto choice = choose(
      "[[tool]]\nasset = \"t\"\n[[tool]]\nasset = \"u\"\nscale = 3\n[[tool]]\nasset = \"t\"\n" +
      object);
  REQUIRE(choice);
  const ForceScene& scene = choice->scene;
  CHECK(tools_meet(scene));
  REQUIRE(tools_of(scene) == 3);
  CHECK(choice->assets.size() == 3);
  CHECK(tool_of(scene, 0)->asset == tool_of(scene, 2)->asset);
  CHECK(tool_of(scene, 1)->placement.scale == 3);
  CHECK(tool_of(scene, 3) == nullptr);
  CHECK(is_tool(scene, tool_of(scene, 1)->asset));
  CHECK_FALSE(is_tool(scene, scene.objects[0].asset));
  CHECK(place_of_tool(*choice, 1).ends_with("line 4: "));
  CHECK(place_of_asset(*choice, tool_of(scene, 1)->asset).ends_with("line 4: "));
  CHECK(scene_of_hand(scene, 1).tool->placement.scale == 3);
  CHECK_FALSE(tools_meet(scene_of_hand(scene, 1)));
  CHECK(check_tool_count(scene, 3, ""));
  for (const std::size_t devices : {1U, 2U, 4U}) {
    const auto wrong = check_tool_count(scene, devices, place_of_tool(*choice, 2));
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().code == ExitCode::invalid_input);
    CHECK(wrong.error().message.find("line 7: the scene names 3 tools for ") != std::string::npos);
  }
  // One tool is for any number of devices, and these pass through each other.
  const auto shared = choose("[tool]\nasset = \"t\"\n" + object);
  REQUIRE(shared);
  CHECK_FALSE(tools_meet(shared->scene));
  CHECK(check_tool_count(shared->scene, 5, ""));
  CHECK(tool_of(shared->scene, 4) == &*shared->scene.tool);
  // A tool that cannot be one is told by its own line.
  AssetMetadata open;
  open.border_edges = 3;
  const auto refused = check_asset(open, *choice, tool_of(scene, 1)->asset);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message.find("line 4: ") != std::string::npos);
}

TEST_CASE("What applications add beside a full tool is of its method") {
  CHECK(choose("[tool]\nasset = \"t\"\n[[object]]\nasset = \"a\"\nmethod = \"paper\"\n")
            ->scene.added.force.method == Method::paper);
  CHECK(choose("[tool]\nasset = \"t\"\n[[object]]\nasset = \"a\"\n")->scene.added.force.method ==
        Method::proxy);
  // A point touches each object by that object's own method.
  CHECK(choose("[[object]]\nasset = \"a\"\nmethod = \"paper\"\n")->scene.added.force.method ==
        Method::proxy);
}

TEST_CASE("A tool meets a full object by method paper alone, and one of its own scale") {
  const auto sparse = choose("[tool]\nasset = \"t\"\n[[object]]\nasset = \"a\"\nscale = 3\n");
  REQUIRE(sparse);
  AssetMetadata full;
  full.form = AssetForm::full;
  const auto unread = check_asset(full, *sparse, 0);
  REQUIRE_FALSE(unread);
  CHECK(unread.error().code == ExitCode::invalid_input);
  CHECK(unread.error().message.find("scene.toml: line 3: ") != std::string::npos);
  CHECK(unread.error().message.find("--form sparse") != std::string::npos);
  const auto paper = [](const std::string& tool, const std::string& object) {
    return choose("[tool]\nasset = \"t\"\nscale = " + tool +
                  "\n[[object]]\nasset = \"a\"\nmethod = \"paper\"\nscale = " + object + "\n");
  };
  CHECK(paper("0.3", "0.3"));
  const auto scaled = paper("1", "2");
  REQUIRE_FALSE(scaled);
  CHECK(scaled.error().code == ExitCode::invalid_input);
  CHECK(scaled.error().message.find("scene.toml: line 4: ") != std::string::npos);
  CHECK(scaled.error().message.find("one 'scale'") != std::string::npos);
}

TEST_CASE("What a point or a ball alone has is refused where the tool is an object") {
  const std::string scene = "[tool]\nasset = \"t\"\n[[object]]\nasset = \"a\"\n";
  ForceOptions options;
  options.probe_form = PaperProbeForm::volume;
  const auto form = choose(scene, options);
  REQUIRE_FALSE(form);
  CHECK(form.error().code == ExitCode::usage);
  CHECK(form.error().message.find("--paper-probe: the tool of ") == 0);
  for (const bool coupling : {true, false}) {
    options = {};
    options.stabilization.emplace();
    (coupling ? options.stabilization->coupling : options.stabilization->potential) = 1;
    const auto refused = choose(scene, options);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ExitCode::usage);
    const char* word = coupling ? "--stabilization coupling: " : "--stabilization potential: ";
    CHECK(refused.error().message.find(word) == 0);
  }
  options.stabilization = recommended_stabilization;
  CHECK(choose(scene, options));
  for (const char* key : {"coupling = \"2N/mm\"", "potential = \"50um\""}) {
    const auto refused = choose(std::string("[stabilization]\n") + key + "\n" + scene);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ExitCode::invalid_input);
    CHECK(refused.error().message.find("scene.toml: line 2: ") != std::string::npos);
    CHECK(refused.error().message.find("the tool is an object") != std::string::npos);
  }
  CHECK(choose("[stabilization]\ncoupling = \"0N/mm\"\ndamping = 1\n" + scene));
}

TEST_CASE("Keys of an object that a tool does not feel are told with the object's line") {
  const std::string tool = "[tool]\nasset = \"t\"\n";
  const auto told = [](const std::string& scene) {
    const auto choice = choose(scene);
    REQUIRE(choice);
    return choice->unfelt;
  };
  const std::string unfelt =
      "[[object]]\nasset = \"a\"\n[[object]]\nasset = \"b\"\nmethod = \"spm\"\n"
      "smoothing = { sigma = \"0.2mm\" }\nturn_limit = \"0rad/s\"\n";
  const auto both = told(tool + unfelt);
  REQUIRE(both.size() == 2);
  CHECK(both[0].find("scene.toml: line 5: 'smoothing' is for a point or a ball") !=
        std::string::npos);
  CHECK(both[1].find("scene.toml: line 5: 'turn_limit'") != std::string::npos);
  CHECK(told(unfelt).empty());
  CHECK(told(tool + "[[object]]\nasset = \"a\"\nfriction = { slide = 0.3 }\n"
                    "damping = \"1Ns/m\"\nturn_limit = \"120rad/s\"\n")
            .empty());
  const auto paper = told(tool +
                          "[[object]]\nasset = \"a\"\nmethod = \"paper\"\n"
                          "friction = { force = \"1N\" }\ntexture = { noise = \"10um\" }\n"
                          "paper_rule = \"all-planes\"\n");
  REQUIRE(paper.size() == 3);
  CHECK(paper[0].find("'friction'") != std::string::npos);
  CHECK(paper[1].find("'texture'") != std::string::npos);
  CHECK(paper[2].find("'paper_rule'") != std::string::npos);
}

TEST_CASE("A coupling beyond any device is told by the line of its key") {
  for (const char* key : {"coupling = \"2000N/mm\"", "turning = \"20000N m/rad\""}) {
    const auto stiff = choose(std::string("[tool]\nasset = \"t\"\nscale = 2\n") + key +
                              "\n[[object]]\nasset = \"a\"\n");
    REQUIRE_FALSE(stiff);
    CHECK(stiff.error().code == ExitCode::invalid_input);
    CHECK(stiff.error().message.find("scene.toml: line 4: ") != std::string::npos);
    CHECK(stiff.error().message.find("or \"auto\"") != std::string::npos);
  }
}

}  // namespace tool_choice_test
