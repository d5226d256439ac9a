// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene_tool.hpp"

#include <catch2/catch.hpp>

#include "tests/formats/scene/scene_text.hpp"
#include "tests/formats/support/synthetic_asset.hpp"

namespace scene_tool_test {

using namespace spm;
using namespace spm::test;

namespace {

/// A scene with these lines in its [tool], which begins in line 1.
Result<Scene> with_tool(const std::string& lines) {
  return scene_of_text("[tool]\n" + lines + "\n[[object]]\nasset = \"a\"\n");
}

}  // namespace

TEST_CASE("A tool's keys become SI, its paths relative to the scene's folder") {
  const TemporaryFolder folder;
  write_bytes(folder.path("scene.toml"), R"([tool]
asset = "drill.spm.exr"
mesh = "meshes/drill.obj"
pose = [0, 0, -0.03, 0, 1, 0, 0]
scale = 0.5
coupling = "1.5N/mm"
turning = "500mNm/rad"
torque_cap = "0.1N m"
spacing = "0.4mm"
budget = "400us"

[[object]]
asset = "teeth.spm.exr"
)");
  const auto scene = read_scene(folder.path("scene.toml"));
  REQUIRE(scene);
  REQUIRE(scene->tool);
  const SceneTool& tool = *scene->tool;
  CHECK_FALSE(scene->probe);
  CHECK(tool.asset == folder.path("drill.spm.exr"));
  CHECK(tool.mesh == folder.path("meshes/drill.obj"));
  CHECK(tool.placement.position == Vector3(0, 0, -0.03));
  CHECK((tool.placement.rotation * Vector3::UnitZ() + Vector3::UnitZ()).norm() < 1e-12);
  CHECK(tool.placement.scale == 0.5);
  CHECK(*tool.coupling == 1500);
  CHECK(*tool.turning == 0.5);
  CHECK(*tool.torque_cap == 0.1);
  CHECK(tool.spacing == Approx(4e-4));
  CHECK(tool.samples == 0);
  CHECK(tool.budget == Approx(4e-4));
  CHECK(tool.line == 2);
}

TEST_CASE("What a tool leaves out, or leaves to the device, stays open") {
  for (const char* lines : {"asset = \"t\"", "asset = \"t\"\ncoupling = \"auto\"",
                            "mesh = \"t.obj\"\nturning = \"auto\""}) {
    INFO(lines);
    const auto scene = with_tool(lines);
    REQUIRE(scene);
    REQUIRE(scene->tool);
    CHECK_FALSE(scene->tool->coupling);
    CHECK_FALSE(scene->tool->turning);
    CHECK_FALSE(scene->tool->torque_cap);
    CHECK(scene->tool->placement.scale == 1);
    CHECK(scene->tool->spacing == 0);
    CHECK(scene->tool->budget == 0);
  }
  CHECK(with_tool("asset = \"t\"\nsamples = 30000")->tool->samples == 30000);
  CHECK(*with_tool("asset = \"t\"\ntorque_cap = \"0mNm\"")->tool->torque_cap == 0);
  CHECK_FALSE(with_tool("probe = \"point\"")->tool);
  CHECK_FALSE(with_tool("")->tool);
}

TEST_CASE("What is wrong in a tool is told by its line, cause and cure") {
  struct Case {
    const char* lines;
    const char* place;
    const char* cause;
  };
  for (const Case& wrong : {
           Case{"probe = \"point\"\nasset = \"t\"", "line 3", "exclude each other"},
           Case{"mesh = \"t.obj\"\nprobe = \"point\"", "line 2", "leave one of them out"},
           Case{"paper_probe = \"volume\"\nasset = \"t\"", "line 2", "'paper_probe'"},
           Case{"mesh = \"t.obj\"\npaper_probe = \"surface\"", "line 3", "leave 'paper_probe' out"},
           Case{"asset = \"t\"\nsamples = 300\nspacing = \"1mm\"", "line 3",
                "'samples' and 'spacing' both"},
           Case{"pose = [0, 0, 0]", "line 2", "add 'asset'"},
           Case{"probe = \"point\"\nscale = 2", "line 3", "add 'asset'"},
           Case{"asset = 3", "line 2", "'asset' must be text"},
           Case{"asset = \"t\"\ncoupling = \"soft\"", "line 3", "800N/m or 1.5N/mm"},
           Case{"asset = \"t\"\ncoupling = \"0N/m\"", "line 3", "above 0"},
           Case{"asset = \"t\"\ncoupling = \"-1N/mm\"", "line 3", "or \"auto\""},
           Case{"asset = \"t\"\nturning = \"automatic\"", "line 3", "or \"auto\""},
           Case{"asset = \"t\"\nturning = 1", "line 3", "or \"auto\""},
           Case{"asset = \"t\"\nturning = \"2N/mm\"", "line 3", "unknown unit"},
           Case{"asset = \"t\"\nturning = 2", "line 3", "text with its unit"},
           Case{"asset = \"t\"\ntorque_cap = \"-1Nm\"", "line 3", "0 or more"},
           Case{"asset = \"t\"\ntorque_cap = \"1N\"", "line 3", "100mNm or 0.1N m"},
           Case{"asset = \"t\"\nsamples = 3", "line 3", "from 6 to 2000000"},
           Case{"asset = \"t\"\nsamples = 5", "line 3", "from 6 to 2000000"},
           Case{"asset = \"t\"\nsamples = 5000000", "line 3", "from 6 to 2000000"},
           Case{"asset = \"t\"\nspacing = \"0mm\"", "line 3", "above 0"},
           Case{"asset = \"t\"\nbudget = \"2s\"", "line 3", "longer than a second"},
           Case{"asset = \"t\"\nscale = 1e7", "line 3", "from 1e-6 to 1e6"},
           Case{"asset = \"t\"\nscale = -1", "line 3", "mirrored"},
           Case{"asset = \"t\"\npose = [0, 0, 0, 2, 0, 0, 0]", "line 3", "unit length"},
           Case{"asset = \"t\"\nstiffness = \"1N/mm\"", "line 3", "unknown key 'stiffness'"},
       }) {
    INFO(wrong.lines);
    const auto scene = with_tool(wrong.lines);
    REQUIRE(!scene);
    INFO(scene.error().message);
    CHECK(scene.error().code == ExitCode::invalid_input);
    CHECK(scene.error().message.find(std::string("scene.toml: ") + wrong.place) !=
          std::string::npos);
    CHECK(scene.error().message.find(wrong.cause) != std::string::npos);
  }
}

TEST_CASE("Each device may have a tool of its own, in the order of the tables") {
  const std::string object = "[[object]]\nasset = \"a\"\n";
  const auto scene = scene_of_text(
      "[[tool]]\nasset = \"t\"\nscale = 2\n[[tool]]\nmesh = \"u.obj\"\n[[tool]]\nasset = \"t\"\n" +
      object);
  REQUIRE(scene);
  REQUIRE(scene->tool);
  CHECK(scene->tool->placement.scale == 2);
  CHECK(scene->tool->line == 2);
  REQUIRE(scene->more_tools.size() == 2);
  CHECK(scene->more_tools[0].mesh.ends_with("u.obj"));
  CHECK(scene->more_tools[0].line == 5);
  CHECK(scene->more_tools[1].asset == scene->tool->asset);
  CHECK(scene->more_tools[1].placement.scale == 1);
  CHECK(scene_of_text("[tool]\nasset = \"t\"\n" + object)->more_tools.empty());
  const auto refused = [&](const std::string& tables, const std::string& line,
                           const std::string& part) {
    const auto wrong = scene_of_text(tables + object);
    REQUIRE_FALSE(wrong);
    INFO(wrong.error().message);
    CHECK(wrong.error().code == ExitCode::invalid_input);
    CHECK(wrong.error().message.find(line) != std::string::npos);
    CHECK(wrong.error().message.find(part) != std::string::npos);
  };
  refused("[[tool]]\nasset = \"t\"\n[[tool]]\nprobe = \"point\"\n",
          "line 4: ", "is of [tool], which all devices share");
  refused("[[tool]]\nasset = \"t\"\nprobe = \"sphere:1mm\"\n", "line 3: ", "write [tool]");
  refused("[[tool]]\nasset = \"t\"\n[[tool]]\n", "line 3: ", "give 'asset'");
  refused("[[tool]]\nasset = \"t\"\nscael = 2\n", "line 3: ", "did you mean 'scale'?");
}

}  // namespace scene_tool_test
