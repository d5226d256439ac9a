// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/scenes.hpp"

#include <catch2/catch.hpp>

#include "formats/files/text_file.hpp"
#include "formats/scene/scene.hpp"
#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::scenes_test {
namespace {

constexpr const char* assets = R"(
[[asset]]
mesh = "meshes/teeth.obj"
output = "baked/teeth.spm.exr"
[[asset]]
mesh = "meshes/drill.obj"
output = "baked/drill.spm.exr"
)";
constexpr const char* scenes = R"(
[[scene]]
scene = "scenes/*.toml"
output = "baked/{stem}.toml"
)";

/// A folder with two meshes, of which nobody reads the content, and a scene of both.
class Library : public test::Folder {
 public:
  Library() {
    write("meshes/teeth.obj", "");
    write("meshes/drill.obj", "");
    std::filesystem::create_directories(path("baked"));
  }

  [[nodiscard]] Result<Manifest> read(const std::string& manifest, const std::string& scene) const {
    write("scenes/dentist.toml", scene);
    return read_manifest(write("assets.toml", manifest));
  }
};

std::string refusal(const Result<Manifest>& manifest) {
  return manifest ? std::string() : manifest.error().message;
}

bool all_done(const ManifestEntry&) { return true; }

}  // namespace

TEST_CASE("A scene that names meshes is written with what was baked from them") {
  const Library folder;
  const auto manifest = folder.read(std::string(assets) + scenes, R"(
[[object]]
mesh = "../meshes/teeth.obj"
stiffness = "2N/mm"
[tool]
mesh = "../meshes/drill.obj"
pose = [0.01, 0, 0]
)");
  REQUIRE(manifest);
  const std::vector<SceneOutcome> outcomes = finish_scenes(*manifest, all_done);
  REQUIRE(outcomes.size() == 1);
  CHECK(outcomes[0].error.empty());
  CHECK(outcomes[0].assets.size() == 2);
  const Result<Scene> written = read_scene(folder.path("baked/dentist.toml"));
  REQUIRE(written);
  CHECK(written->objects[0].asset == folder.path("baked/teeth.spm.exr"));
  CHECK(std::filesystem::weakly_canonical(written->objects[0].mesh) ==
        std::filesystem::weakly_canonical(folder.path("meshes/teeth.obj")));
  CHECK(written->objects[0].stiffness == Approx(2000));
  REQUIRE(written->tool);
  CHECK(written->tool->asset == folder.path("baked/drill.spm.exr"));
  CHECK(written->tool->placement.position.x() == Approx(0.01));
}

TEST_CASE("Tools of several devices each get their own baked file") {
  const Library folder;
  const auto manifest = folder.read(std::string(assets) + scenes, R"(
[[tool]]
mesh = "../meshes/drill.obj"
[[tool]]
mesh = "../meshes/teeth.obj"
[[object]]
asset = "../baked/teeth.spm.exr"
)");
  REQUIRE(manifest);
  CHECK(finish_scenes(*manifest, all_done)[0].ok());
  const Result<Scene> written = read_scene(folder.path("baked/dentist.toml"));
  REQUIRE(written);
  CHECK(written->tool->asset == folder.path("baked/drill.spm.exr"));
  REQUIRE(written->more_tools.size() == 1);
  CHECK(written->more_tools[0].asset == folder.path("baked/teeth.spm.exr"));
}

TEST_CASE("A scene with the right bytes is not touched") {
  const Library folder;
  const auto manifest =
      folder.read(std::string(assets) + scenes, "[[object]]\nmesh = \"../meshes/teeth.obj\"\n");
  REQUIRE(manifest);
  CHECK(finish_scenes(*manifest, all_done)[0].ok());
  const std::string file = folder.path("baked/dentist.toml");
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(24);
  std::filesystem::last_write_time(file, long_ago);
  CHECK(finish_scenes(*manifest, all_done)[0].ok());
  CHECK(std::filesystem::last_write_time(file) == long_ago);
}

TEST_CASE("A scene is not written where one of its assets was not baked") {
  const Library folder;
  const auto manifest =
      folder.read(std::string(assets) + scenes, "[[object]]\nmesh = \"../meshes/teeth.obj\"\n");
  REQUIRE(manifest);
  const auto outcomes =
      finish_scenes(*manifest, [](const ManifestEntry& entry) { return entry.name == "drill"; });
  CHECK(outcomes[0].code == ExitCode::batch_failed);
  CHECK_THAT(outcomes[0].error, Catch::Contains("teeth"));
  CHECK_FALSE(std::filesystem::exists(folder.path("baked/dentist.toml")));
}

TEST_CASE("A scene without an output is checked and left where it is") {
  const Library folder;
  const auto manifest =
      folder.read(std::string(assets) + "[[scene]]\nscene = \"scenes/dentist.toml\"\n",
                  "[[object]]\nmesh = \"../meshes/teeth.obj\"\n");
  REQUIRE(manifest);
  CHECK(finish_scenes(*manifest, all_done)[0].ok());
  CHECK(std::filesystem::is_empty(folder.path("baked")));
}

TEST_CASE("A scene is read once: one that is edited meanwhile is written as it was checked") {
  const Library folder;
  const std::string object = "[[object]]\nmesh = \"../meshes/teeth.obj\"\n";
  const auto manifest =
      folder.read(std::string(assets) + scenes, object + "stiffness = \"2N/mm\"\n");
  REQUIRE(manifest);
  folder.write("scenes/dentist.toml", "not a scene");
  CHECK(finish_scenes(*manifest, all_done)[0].error.empty());
  const Result<Scene> written = read_scene(folder.path("baked/dentist.toml"));
  REQUIRE(written);
  CHECK(written->objects[0].stiffness == Approx(2000));
}

TEST_CASE("A scene that its manifest does not suit is refused with both lines") {
  const Library folder;
  const auto said = [&](const std::string& scene, const std::string& manifest = assets) {
    return refusal(folder.read(manifest + scenes, scene));
  };
  const std::string misspelt = said("[[object]]\nmesh = \"../meshes/teeth.obj\"\nstifness = 1\n");
  CHECK_THAT(misspelt, Catch::Contains("assets.toml: line 10: 'scene'") &&
                           Catch::Contains("dentist.toml: line 3"));
  CHECK_THAT(said("[[object]]\nmesh = \"../meshes/gum.obj\"\n"),
             Catch::Contains("gum.obj is the mesh of no asset") && Catch::Contains("line 1"));
  CHECK_THAT(said("[[object]]\nasset = \"gum.spm.exr\"\n"), Catch::Contains("is no output of"));
  CHECK_THAT(said("[[object]]\nmesh = \"../meshes/teeth.obj\"\nmethod = \"paper\"\n"),
             Catch::Contains("form = \"full\""));
  CHECK_THAT(said("[tool]\nprobe = \"sphere:1mm\"\n[[object]]\nmesh = \"../meshes/teeth.obj\"\n"),
             Catch::Contains("probe = \"sphere:1mm\""));
  CHECK(said("[tool]\nprobe = \"sphere:1mm\"\n[[object]]\nmesh = \"../meshes/teeth.obj\"\n",
             "[defaults]\nprobe = \"sphere:1mm\"\n" + std::string(assets))
            .empty());
  CHECK_THAT(said("[[object]]\nmesh = \"../meshes/teeth.obj\"\n",
                  std::string(assets) +
                      "[[asset]]\nmesh = \"meshes/teeth.obj\"\noutput = \"baked/fine.spm.exr\"\n"),
             Catch::Contains("several assets") && Catch::Contains("fine.spm.exr"));
}

TEST_CASE("Tables of scenes are held to their keys and own outputs") {
  const Library folder;
  const auto said = [&](const std::string& tables) {
    return refusal(folder.read(assets + tables, "[[object]]\nmesh = \"../meshes/teeth.obj\"\n"));
  };
  CHECK_THAT(said("[[scene]]\noutput = \"baked/a.toml\"\n"),
             Catch::Contains("line 8") && Catch::Contains("'scene' is missing"));
  CHECK_THAT(said("[[scene]]\nscene = \"scenes/none*.toml\"\n"),
             Catch::Contains("no file matches"));
  CHECK_THAT(said("[[scene]]\nscene = \"scenes/dentist.toml\"\noutpt = \"a.toml\"\n"),
             Catch::Contains("line 10") && Catch::Contains("did you mean 'output'?"));
  CHECK_THAT(said("[[scene]]\nscene = \"scenes/dentist.toml\"\noutput = \"scenes/dentist.toml\"\n"),
             Catch::Contains("is the scene itself"));
  CHECK_THAT(said("[[scene]]\nscene = \"scenes/dentist.toml\"\noutput = \"baked/teeth.spm.exr\"\n"),
             Catch::Contains("line 10") && Catch::Contains("of line 4"));
  CHECK_THAT(
      said("[[scene]]\nscene = \"scenes/dentist.toml\"\noutput = \"scenes/dentist.toml/a.toml\"\n"),
      Catch::Contains("line 10: 'output'"));
}

}  // namespace spm::baker::scenes_test
