// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/manifest.hpp"

#include <catch2/catch.hpp>

#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::manifest_test {
namespace {

/// A folder with four meshes, of which nobody reads the content.
class Meshes : public test::Folder {
 public:
  Meshes() {
    for (const char* name : {"one.obj", "parts/b.obj", "parts/a.obj", "parts/c.stl"}) {
      write(name, "");
    }
    std::filesystem::create_directories(path("parts/d.obj"));
  }

  [[nodiscard]] Result<Manifest> read(const std::string& text) const {
    return read_manifest(write("assets.toml", text));
  }
};

std::vector<std::string> outputs(const Manifest& manifest) {
  std::vector<std::string> names;
  for (const ManifestEntry& entry : manifest.entries) names.push_back(entry.output);
  return names;
}

/// The message of a refusal; empty where there was none.
std::string refusal(const Result<Manifest>& manifest) {
  return manifest ? std::string() : manifest.error().message;
}

}  // namespace

TEST_CASE("Defaults hold for every asset that says nothing else") {
  const Meshes folder;
  const auto manifest = folder.read(R"(
[[asset]]
mesh = "one.obj"
output = "one.spm.exr"
[[asset]]
mesh = "parts/a.obj"
output = "a.spm.exr"
tolerance = "20um"
[defaults]
tolerance = "50um"
max-depth = "1mm"
)");
  REQUIRE(manifest);
  REQUIRE(manifest->entries.size() == 2);
  CHECK(*manifest->entries[0].request.bake.tolerance == Approx(50e-6));
  CHECK(*manifest->entries[1].request.bake.tolerance == Approx(20e-6));
  for (const ManifestEntry& entry : manifest->entries) {
    CHECK(entry.request.bake.max_depth == Approx(1e-3));
  }
}

TEST_CASE("A flag of the defaults is taken back by an asset") {
  const Meshes folder;
  const auto manifest = folder.read(R"(
[defaults]
allow-inexact = true
[[asset]]
mesh = "one.obj"
output = "one.spm.exr"
allow-inexact = false
[[asset]]
mesh = "one.obj"
output = "two.spm.exr"
)");
  REQUIRE(manifest);
  CHECK_FALSE(manifest->entries[0].request.allow_inexact);
  CHECK(manifest->entries[1].request.allow_inexact);
}

TEST_CASE("A pattern gives an asset for each mesh, in the order of their names") {
  const Meshes folder;
  const auto manifest = folder.read(R"(
[[asset]]
mesh = "parts/*"
output = "baked/{folder}-{stem}.spm.exr"
name = "{stem} of {folder}"
)");
  REQUIRE(manifest);
  CHECK(outputs(*manifest) == std::vector<std::string>{"baked/parts-a.spm.exr",
                                                       "baked/parts-b.spm.exr",
                                                       "baked/parts-c.spm.exr"});
  CHECK(manifest->entries[0].name == "a of parts");
  CHECK(manifest->entries[0].request.mesh == folder.path("parts/a.obj"));
  CHECK(manifest->searched_folders == std::vector<std::string>{folder.path("parts")});
}

TEST_CASE("A mesh that has a table of its own is left out of patterns") {
  const Meshes folder;
  const auto manifest = folder.read(R"(
[defaults]
output = "{stem}.spm.exr"
[[asset]]
mesh = "parts/*.obj"
[[asset]]
mesh = "./parts/a.obj"
tolerance = "10um"
)");
  REQUIRE(manifest);
  CHECK(outputs(*manifest) == std::vector<std::string>{"b.spm.exr", "a.spm.exr"});
  CHECK(manifest->entries[1].request.bake.tolerance.has_value());
}

TEST_CASE("A file whose name looks like a pattern is that file") {
  const Meshes folder;
  static_cast<void>(folder.write("part[1].obj", ""));
  const auto manifest = folder.read("[[asset]]\nmesh = \"part[1].obj\"\noutput = \"x.spm.exr\"\n");
  REQUIRE(manifest);
  CHECK(manifest->entries[0].request.mesh == folder.path("part[1].obj"));
}

TEST_CASE("A manifest's folder may have characters of a pattern in its name") {
  const Meshes folder;
  static_cast<void>(folder.write("a[b]*/m.obj", ""));
  const auto manifest = read_manifest(folder.write(
      "a[b]*/assets.toml", "[[asset]]\nmesh = \"*.obj\"\noutput = \"{stem}.spm.exr\"\n"));
  REQUIRE(manifest);
  CHECK(manifest->entries.size() == 1);
}

TEST_CASE("Each mistake in a manifest is told with its line and its key") {
  const Meshes folder;
  const std::string asset = "[[asset]]\nmesh = \"one.obj\"\noutput = \"one.spm.exr\"\n";
  const auto [what, text, line, word] =
      GENERATE_COPY(table<std::string, std::string, std::string, std::string>({
          {"a misspelt key of the defaults", asset + "[defaults]\ntolerence = \"1um\"\n", "line 5",
           "'tolerance'"},
          {"a mesh for all", asset + "[defaults]\nmesh = \"one.obj\"\n", "line 5", "'mesh'"},
          {"two tables of defaults", asset + "[[defaults]]\n", "line 4", "'defaults'"},
          {"a wrong default", asset + "[defaults]\nseed = 1\ntolerance = \"1\"\n", "line 6",
           "tolerance"},
          {"no mesh", asset + "[[asset]]\noutput = \"x\"\n", "line 4", "'mesh'"},
          {"nothing matches", "[[asset]]\noutput = \"{stem}\"\nmesh = \"none/*.obj\"\n", "line 3",
           "'mesh'"},
          {"a foreign word in braces", "[[asset]]\nmesh = \"one.obj\"\noutput = \"{name}.exr\"\n",
           "line 3", "'{name}'"},
          {"a pattern with one output", "[[asset]]\nmesh = \"parts/*.obj\"\noutput = \"x.exr\"\n",
           "line 3", "{stem}"},
          {"an output by another name",
           asset + "[[asset]]\nmesh = \"parts/a.obj\"\noutput = \"parts/../one.spm.exr\"\n",
           "line 6", "line 3"},
      }));
  INFO(what);
  const std::string message = refusal(folder.read(text));
  CHECK_THAT(message, Catch::Contains("assets.toml: " + line + ":"));
  CHECK_THAT(message, Catch::Contains(word));
}

TEST_CASE("A manifest of very many meshes is read in one go") {
  const Meshes folder;
  for (int i = 0; i < 3000; ++i) folder.write("many/" + std::to_string(i) + ".obj", "");
  const auto manifest =
      folder.read("[[asset]]\nmesh = \"many/*.obj\"\noutput = \"{stem}.spm.exr\"\n");
  REQUIRE(manifest);
  CHECK(manifest->entries.size() == 3000);
}

}  // namespace spm::baker::manifest_test
