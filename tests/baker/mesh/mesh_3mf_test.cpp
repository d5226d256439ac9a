// SPDX-License-Identifier: GPL-3.0-or-later
#include <zip.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "tests/baker/mesh/mesh_support.hpp"

namespace spm::test::mesh_3mf_test {
namespace {

using baker::Mesh;

const std::string relations =
    R"(<?xml version="1.0"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="r0"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";
const std::string mesh =
    R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices>
<triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
<triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh>)";
const std::string object = "<object id=\"1\">" + mesh + "</object>";

std::string model(const std::string& resources, const std::string& items,
                  const std::string& attributes = "") {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
 xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02" )" +
         attributes + "><resources>" + resources + "</resources><build>" + items +
         "</build></model>";
}

/// Writes a package of these parts.
std::string package(const TemporaryFolder& folder, const std::string& text,
                    std::map<std::string, std::string> parts = {}) {
  parts.emplace("_rels/.rels", relations);
  parts.emplace("3D/3dmodel.model", text);
  std::string path = folder.path("m.3mf");
  zip_t* const archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  REQUIRE(archive != nullptr);
  for (const auto& [name, bytes] : parts) {
    zip_source_t* const source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    REQUIRE(zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8) >= 0);
  }
  REQUIRE(zip_close(archive) == 0);
  return path;
}

Mesh load(const std::string& text, std::map<std::string, std::string> parts = {},
          const baker::LoadOptions& options = {}) {
  const TemporaryFolder folder;
  return baker::load_mesh(package(folder, text, std::move(parts)), options);
}

std::string refusal_of(const std::string& path) {
  try {
    (void)baker::load_mesh(path, {});
  } catch (const baker::BakeError& error) {
    std::string message = error.what();
    CHECK(error.code() == ExitCode::invalid_input);
    CHECK_THAT(message, Catch::StartsWith(path + ": ") && Catch::Contains("; "));
    CHECK(message.find('\n') == std::string::npos);
    return message;
  }
  return "it was loaded";
}

std::string refusal(const std::string& text, std::map<std::string, std::string> parts = {}) {
  const TemporaryFolder folder;
  return refusal_of(package(folder, text, std::move(parts)));
}

double volume(const Mesh& found) { return signed_volume(found.vertices, found.triangles); }

const std::string item = R"(<item objectid="1"/>)";

}  // namespace

TEST_CASE("A 3MF is read in its own unit, which --unit overrides") {
  const Mesh found = load(model(object, item));
  CHECK(found.triangles.size() == 4);
  CHECK(found.closed());
  CHECK(found.inverted_components == 0);
  CHECK(found.unit == 1e-3);
  CHECK(volume(found) == Approx(1e-9 / 6));
  CHECK(load(model(object, item, "unit=\"inch\"")).unit == 0.0254);
  CHECK(load(model(object, item, "unit=\"meter\"")).box_max == Vector3(1, 1, 1));
  CHECK(load(model(object, item, "unit=\"inch\""), {}, {.unit = 1}).box_max == Vector3(1, 1, 1));
  CHECK_THAT(refusal(model(object, item, "unit=\"ell\"")), Catch::Contains("--unit"));
}

TEST_CASE("A 3MF's items and components are placed by their transforms") {
  const std::string meter = "unit=\"meter\"";
  SECTION("moved, scaled and mirrored") {
    const Mesh found = load(model(object,
                                  R"(<item objectid="1" transform="2 0 0 0 2 0 0 0 2 5 6 7"/>
<item objectid="1" transform="1 0 0 0 1 0 0 0 -1 0 0 -3"/>)",
                                  meter));
    CHECK(found.components == 2);
    CHECK(found.inverted_components == 0);
    CHECK(volume(found) == Approx(9.0 / 6));
    CHECK(found.box_max == Vector3(7, 8, 9));
    CHECK(found.box_min == Vector3(0, 0, -4));
  }
  SECTION("turned: points are multiplied from the left") {
    // x goes to y.
    const Mesh found =
        load(model(object, R"(<item objectid="1" transform="0 1 0 -1 0 0 0 0 1 0 0 0"/>)", meter));
    CHECK(found.box_min == Vector3(-1, 0, 0));
    CHECK(found.box_max == Vector3(0, 1, 1));
  }
  SECTION("components, the inner transform first") {
    const std::string parts = object + R"(<object id="2"><components>
<component objectid="1" transform="1 0 0 0 1 0 0 0 1 1 0 0"/><component objectid="1"/>
</components></object>)";
    const Mesh found =
        load(model(parts, R"(<item objectid="2" transform="3 0 0 0 3 0 0 0 3 0 0 10"/>)", meter));
    CHECK(volume(found) == Approx(2 * 27.0 / 6));
    CHECK(found.box_max == Vector3(6, 3, 13));
  }
  SECTION("objects of another part, as slicers write them") {
    const std::string parts = R"(<object id="4"><components>
<component objectid="1" p:path="/3D/Objects/a.model"/></components></object>)";
    const std::string text =
        model(parts, R"(<item objectid="4"/>)", meter + " requiredextensions=\"p\"");
    CHECK(volume(load(text, {{"3D/Objects/a.model", model(object, "")}})) == Approx(1.0 / 6));
    CHECK_THAT(refusal(text), Catch::Contains("3D/Objects/a.model cannot be read"));
  }
  SECTION("what is not in the build is left out") {
    CHECK(load(model(object + "<object id=\"9\">" + mesh + "</object>", item)).components == 1);
  }
}

TEST_CASE("A bad 3MF is refused with a sentence that names part, line and cause") {
  const std::string triangle = R"(<triangle v1="0" v2="2" v3="1"/>)";
  const auto with = [&](const std::string& other) {
    std::string text = object;
    return model(text.replace(text.find(triangle), triangle.size(), other), item);
  };
  CHECK_THAT(refusal(with(R"(<triangle v1="0" v2="4" v3="1"/>)")),
             Catch::Contains("3D/3dmodel.model: line 6: vertex index 4 is out of range"));
  CHECK_THAT(refusal(with(R"(<triangle v1="0" v2="1"/>)")), Catch::Contains("'v3' is missing"));
  CHECK_THAT(refusal(with(R"(<triangle v1="0" v2="-1" v3="1"/>)")), Catch::Contains("'v2' is no"));
  CHECK_THAT(refusal(with(R"(<vertex x="nan" y="0" z="0"/>)")), Catch::Contains("'x' is no"));
  CHECK_THAT(refusal(with("<triangle")), Catch::Contains("line 6: broken XML"));
  CHECK_THAT(refusal(model(object, R"(<item objectid="3"/>)")), Catch::Contains("no object 3"));
  CHECK_THAT(refusal(model(object + object, item)), Catch::Contains("object 1 is there twice"));
  CHECK_THAT(refusal(model(object, R"(<item objectid="1" transform="1 0 0"/>)")),
             Catch::Contains("'transform' is no number"));
  CHECK_THAT(refusal(model(object, item, "requiredextensions=\"p b\"")),
             Catch::Contains("it needs the extension http") && Catch::Contains("beamlattice"));
  CHECK_THAT(refusal(model("", "")), Catch::Contains("no face"));
  CHECK_THAT(refusal(model(mesh, item)), Catch::Contains("outside any object"));
  CHECK_THAT(refusal(R"(<!DOCTYPE m [<!ENTITY a "aa">]><m>&a;</m>)"),
             Catch::Contains("a document type"));
  CHECK_THAT(refusal("", {{"_rels/.rels", "<Relationships/>"}}), Catch::Contains("no 3D model"));
  CHECK_THAT(refusal(model(R"(<object id="1"><components><component objectid="1"/>
<component objectid="1"/></components></object>)",
                           item)),
             Catch::Contains("a part is one of its own"));
  CHECK_THAT(refusal(model(std::string(80U << 20U, ' '), item)),
             Catch::Contains("100 times as large"));
}

TEST_CASE("A 3MF cut anywhere or under another name is refused") {
  const TemporaryFolder folder;
  std::ifstream file(package(folder, model(object, item)), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  for (std::size_t size = 1; size < whole.size(); size += 11) {
    (void)refusal_of(folder.write("cut.3mf", whole.substr(0, size)));
  }
  CHECK_THAT(refusal_of(folder.write("m.obj", whole)), Catch::Contains("looks like 3MF"));
}

}  // namespace spm::test::mesh_3mf_test
