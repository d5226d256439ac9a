// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/asset_json.hpp"

#include <catch2/catch.hpp>
#include <clocale>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/skip.hpp"

namespace asset_json_test {

namespace {

using namespace spm;
using namespace spm::test;
using Json = nlohmann::ordered_json;

std::string sparse_text() { return to_json(describe(sparse_asset(1))); }

std::string full_text() {
  AssetDescription description = describe(full_asset(1, {2, 1, 2}));
  description.plane_tile = {0, 2, 1};
  return to_json(description);
}

}  // namespace

TEST_CASE("A description reads back to the same text") {
  for (const std::string& text : {sparse_text(), full_text()}) {
    const auto parsed = parse_description(text, "a.exr");
    REQUIRE(parsed.has_value());
    CHECK(to_json(*parsed) == text);
  }
}

TEST_CASE("Numbers of a description round-trip to the last bit") {
  AssetDescription description = describe(full_asset(3, {1, 1}));
  Random random(9);
  for (int k = 0; k < 500; ++k) {
    description.plane_spacing[0] =
        std::ldexp(random.between(0.5, 1), static_cast<int>(below(random, 70)) - 35);
    const auto parsed = parse_description(to_json(description), "a.exr");
    REQUIRE(parsed.has_value());
    REQUIRE(parsed->plane_spacing == description.plane_spacing);
  }
}

TEST_CASE("A description does not depend on the locale") {
  const std::string before = sparse_text();
  const char* set = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const std::string after = sparse_text();
  const auto parsed = parse_description(before, "a.exr");
  std::setlocale(LC_ALL, "C");
  if (set == nullptr) SPM_SKIP("the locale de_DE.UTF-8 is not there");
  CHECK(after == before);
  REQUIRE(parsed.has_value());
  CHECK(to_json(*parsed) == before);
}

TEST_CASE("A key that a later program may add is ignored") {
  Json json = Json::parse(sparse_text());
  json["something_new"] = 1;
  CHECK(parse_description(json.dump(), "a.exr").has_value());
}

TEST_CASE("Every wrong field of a description is refused by its name") {
  struct Case {
    const char* named;
    std::function<void(Json&)> damage;
  };
  const std::vector<Case> cases = {
      {"format_version", [](Json& j) { j["format_version"] = "2"; }},
      {"format version 14, this program reads 13", [](Json& j) { j["format_version"] = 14; }},
      {"`form`", [](Json& j) { j["form"] = "dense"; }},
      {"`units`", [](Json& j) { j["units"] = "mm"; }},
      {"`kind`", [](Json& j) { j.erase("kind"); }},
      {"`mesh_sha256`", [](Json& j) { j["mesh_sha256"] = std::string(64, 'G'); }},
      {"`options`", [](Json& j) { j["options"] = 3; }},
      {"`tolerance`", [](Json& j) { j["tolerance"] = nullptr; }},
      {"`tolerance`", [](Json& j) { j["tolerance"] = 0; }},
      {"`tolerance`", [](Json& j) { j["tolerance"] = -1e-5; }},
      {"`certified`", [](Json& j) { j["certified"] = -1e-5; }},
      {"`certified`", [](Json& j) { j["certified"] = "none"; }},
      {"`tolerance_met`", [](Json& j) { j["tolerance_met"] = 1; }},
      {"`band.max_depth`", [](Json& j) { j["band"]["max_depth"] = -1; }},
      {"`band.margin`", [](Json& j) { j["band"]["margin"] = "1"; }},
      {"`band`",
       [](Json& j) {
         j["band"] = Json::array({1, 2});
       }},
      {"`probe.radius`", [](Json& j) { j["probe"].erase("radius"); }},
      {"`layers_max`", [](Json& j) { j["layers_max"] = -1; }},
      {"`inconsistent_samples`", [](Json& j) { j["inconsistent_samples"] = 1.5; }},
      {"`tried_area`", [](Json& j) { j["tried_area"] = -0.5; }},
      {"`fallback_cells`", [](Json& j) { j["fallback_cells"] = nullptr; }},
      {"`mesh.unit`", [](Json& j) { j["mesh"]["unit"] = 0; }},
      {"`mesh.scale`", [](Json& j) { j["mesh"]["scale"] = -2; }},
      {"`mesh.box_min`",
       [](Json& j) {
         j["mesh"]["box_min"] = Json::array({1, 2});
       }},
      {"`mesh.box_max`",
       [](Json& j) {
         j["mesh"]["box_max"] = Json::array({-9, -9, -9});
       }},
      {"`mesh.closed`", [](Json& j) { j["mesh"]["closed"] = "yes"; }},
      {"`mesh.triangles`", [](Json& j) { j["mesh"]["triangles"] = 1.5; }},
      {"`planes`", [](Json& j) { j["planes"] = 1; }},
      {"`planes[0].x0`", [](Json& j) { j["planes"][0].erase("x0"); }},
      {"`planes[1].u`", [](Json& j) { j["planes"][1]["u"].push_back(0); }},
      {"`planes[2].n`",
       [](Json& j) {
         j["planes"][2]["n"] = Json::array({0, 0, 2});
       }},
      {"`planes[2].n`", [](Json& j) { std::swap(j["planes"][2]["u"], j["planes"][2]["v"]); }},
  };
  for (const Case& wrong : cases) {
    Json json = Json::parse(sparse_text());
    wrong.damage(json);
    INFO(wrong.named);
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().code == ExitCode::invalid_input);
    INFO(parsed.error().message);
    CHECK(parsed.error().message.find("a.exr: ") == 0);
    CHECK(parsed.error().message.find(wrong.named) != std::string::npos);
    CHECK(parsed.error().message.find("; bake it again") != std::string::npos);
  }
}

TEST_CASE("Every wrong field of the full form's plane table is refused by its name") {
  for (const char* key : {"spacing", "tile"}) {
    Json json = Json::parse(full_text());
    json["planes"][1][key] = -1;
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().message.find("planes[1]." + std::string(key)) != std::string::npos);
  }
  for (const char* key : {"count", "columns", "rows"}) {
    Json json = Json::parse(full_text());
    json["maps"][key] = 1 << 25;
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().message.find("maps." + std::string(key)) != std::string::npos);
  }
  Json json = Json::parse(full_text());
  json["planes"].erase(0);
  CHECK(!parse_description(json.dump(), "a.exr").has_value());
  json = Json::parse(full_text());
  json["tolerance"] = 1e-5;
  CHECK(!parse_description(json.dump(), "a.exr").has_value());
  json = Json::parse(full_text());
  json["certified"] = 1e-5;
  CHECK(!parse_description(json.dump(), "a.exr").has_value());
}

TEST_CASE("Every wrong field of the full form's grid is refused by its name") {
  const std::vector<std::pair<const char*, Json>> cases = {
      {"origin", Json::array({0, "x", 0})},
      {"origin", nullptr},
      {"cell_size", 0},
      {"cells", Json::array({0, 7, 7})},
      {"cells", Json::array({7, 7})},
      {"cells", Json::array({1 << 20, 1 << 20, 1 << 20})},
      {"records", 1ULL << 40U},
      {"records", "many"}};
  for (const auto& [key, value] : cases) {
    Json json = Json::parse(full_text());
    json["grid"][key] = value;
    INFO(key << ": " << value.dump());
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().code == ExitCode::invalid_input);
    CHECK(parsed.error().message.find("`grid." + std::string(key) + "`") != std::string::npos);
  }
}

TEST_CASE("Every wrong field of the octree, its maps and its triangles is refused by its name") {
  struct Case {
    const char *object, *key;
    Json value;
  };
  const std::vector<Case> cases = {{"octree", "origin", Json::array({0, "x", 0})},
                                   {"octree", "origin", nullptr},
                                   {"octree", "edge", 0},
                                   {"octree", "edge", 1e30},
                                   {"octree", "roots", Json::array({0, 4, 4})},
                                   {"octree", "roots", Json::array({4, 4})},
                                   {"octree", "roots", Json::array({1 << 20, 1 << 20, 1 << 20})},
                                   {"octree", "words", 1ULL << 40U},
                                   {"octree", "words", -2},
                                   {"octree", "lists", "many"},
                                   {"octree", "lists", 1ULL << 40U},
                                   {"octree", "clearance_unit", -1e-4},
                                   {"octree", "reach", 1e30},
                                   {"octree", "beyond_share", 1.01},
                                   {"octree", "beyond_share", "most"},
                                   {"atlas", "charts", 1 << 15},
                                   {"atlas", "charts", -1},
                                   {"atlas", "width", 3},
                                   {"atlas", "spacing", 0},
                                   {"atlas", "offset", 1e-9},
                                   {"atlas", "offset", "1 mm"},
                                   {"atlas", "offset", nullptr},
                                   {"exact", "triangles", 1ULL << 40U},
                                   {"exact", "triangles", 0.5},
                                   {"exact", "corners", 1 << 22},
                                   {"exact", "origin", Json::array({1, 2})},
                                   {"exact", "step", 0},
                                   {"exact", "step", "1 um"}};
  for (const auto& [object, key, value] : cases) {
    Json json = Json::parse(sparse_text());
    json[object][key] = value;
    const std::string named = "`" + std::string(object) + "." + key + "`";
    INFO(named << ": " << value.dump());
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().code == ExitCode::invalid_input);
    CHECK(parsed.error().message.find(named) != std::string::npos);
  }
  for (const char* object : {"octree", "atlas", "exact"}) {
    Json json = Json::parse(sparse_text());
    json.erase(object);
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().message.find("`" + std::string(object) + "`") != std::string::npos);
  }
}

TEST_CASE("A file of another format version is refused with who wrote it and what to do") {
  for (const auto& [version, cure] :
       {std::pair{4, "; an older spm-bake wrote it; bake it again"},
        {asset_format_version + 1,
         "; a newer spm-bake wrote it, update this one; bake it again"}}) {
    Json json = Json::parse(sparse_text());
    json["format_version"] = version;
    // Other versions have other fields, which are not looked at.
    json.erase("octree");
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().code == ExitCode::invalid_input);
    CHECK(parsed.error().message == "a.exr: format version " + std::to_string(version) +
                                        ", this program reads " +
                                        std::to_string(asset_format_version) + cure);
  }
}

TEST_CASE("A description has the partition of its own form alone") {
  const Json sparse = Json::parse(sparse_text()), full = Json::parse(full_text());
  for (const char* key : {"octree", "exact", "atlas"}) {
    CHECK(sparse.contains(key));
    CHECK(!full.contains(key));
  }
  for (const char* key : {"grid", "maps", "triangles"}) {
    CHECK(full.contains(key));
    CHECK(!sparse.contains(key));
  }
}

TEST_CASE("The units of an octree and its triangles round-trip to the last bit") {
  AssetDescription description = describe(sparse_asset(3));
  Random random(10);
  for (int k = 0; k < 200; ++k) {
    OctreeData& octree = description.octree;
    for (double* unit :
         {&octree.edge, &octree.clearance_unit, &octree.reach, &octree.lattice_step}) {
      *unit = std::ldexp(random.between(0.5, 1), static_cast<int>(below(random, 40)) - 30);
    }
    octree.beyond_share = random.between(0, 1);
    const auto parsed = parse_description(to_json(description), "a.exr");
    REQUIRE(parsed.has_value());
    REQUIRE(parsed->octree.beyond_share == octree.beyond_share);
    REQUIRE(parsed->octree.edge == octree.edge);
    REQUIRE(parsed->octree.clearance_unit == octree.clearance_unit);
    REQUIRE(parsed->octree.reach == octree.reach);
    REQUIRE(parsed->octree.lattice_step == octree.lattice_step);
  }
}

TEST_CASE("The place of an asset's offset surface round-trips to the last bit") {
  AssetDescription description = describe(sparse_asset(3));
  Random random(11);
  for (int k = 0; k < 200; ++k) {
    description.atlas.offset = k == 0 ? 0 : -random.between(0, 0.01);
    const auto parsed = parse_description(to_json(description), "a.exr");
    REQUIRE(parsed.has_value());
    REQUIRE(parsed->atlas.offset == description.atlas.offset);
  }
}

TEST_CASE("An offset surface that would lie outside its surface is refused") {
  Json json = Json::parse(sparse_text());
  REQUIRE(json["atlas"]["offset"].get<double>() < 0);
  for (const double above : {5e-324, 1e-9, 0.0015}) {
    json["atlas"]["offset"] = above;
    CAPTURE(above);
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().code == ExitCode::invalid_input);
    CHECK(parsed.error().message.find("`atlas.offset`") != std::string::npos);
  }
  for (const double below : {0.0, -1e-9, -0.0015}) {
    json["atlas"]["offset"] = below;
    CAPTURE(below);
    CHECK(parse_description(json.dump(), "a.exr").has_value());
  }
}

TEST_CASE("An octree that does not say what it promises beyond the margin promises nothing") {
  Json json = Json::parse(sparse_text());
  json["octree"].erase("beyond_share");
  const auto parsed = parse_description(json.dump(), "a.exr");
  REQUIRE(parsed.has_value());
  CHECK(parsed->octree.beyond_share == 0);
}

TEST_CASE("A description that nests too deep is refused, wherever it does") {
  for (const char* key : {"options", "something_new", "planes"}) {
    std::string text = sparse_text();
    const std::string deep = std::string(66'000, '[') + std::string(66'000, ']');
    text.insert(1, '"' + std::string(key) + "\":" + deep + ",");
    const auto parsed = parse_description(text, "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().code == ExitCode::invalid_input);
    CHECK(parsed.error().message ==
          "a.exr: its `spm` attribute is not a JSON object of at most 64 levels; bake it again");
  }
}

TEST_CASE("A number of a description that is beyond all sizes is refused by its name") {
  const std::vector<std::pair<const char*, double>> cases = {
      {"/tolerance", 1e30},      {"/certified", 1e30},       {"/band/max_depth", 1e154},
      {"/band/margin", 1e154},   {"/probe/radius", 1e300},   {"/mesh/unit", 1e300},
      {"/mesh/diagonal", 1e200}, {"/mesh/box_max/1", 1e200}, {"/octree/origin/0", 1e200},
      {"/octree/edge", 1e13},    {"/exact/step", 1e13},      {"/exact/origin/2", -1e200},
      {"/atlas/spacing", 1e13},  {"/planes/0/x0/1", 1e200},  {"/octree/reach", 1e13},
      {"/atlas/offset", -1e13}};
  for (const auto& [place, value] : cases) {
    Json json = Json::parse(sparse_text());
    json[Json::json_pointer(place)] = value;
    CAPTURE(place);
    const auto parsed = parse_description(json.dump(), "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().code == ExitCode::invalid_input);
  }
  for (const auto& [place, value] :
       std::vector<std::pair<const char*, double>>{{"/grid/cell_size", 5e-324},
                                                   {"/grid/cell_size", 1e200},
                                                   {"/grid/origin/0", 1e200},
                                                   {"/planes/0/spacing", 5e-324}}) {
    Json json = Json::parse(full_text());
    json[Json::json_pointer(place)] = value;
    CAPTURE(place, value);
    CHECK(!parse_description(json.dump(), "a.exr"));
  }
}

TEST_CASE("Text that is no JSON object is refused") {
  for (const char* text :
       {"", "[]", "3", "{", "{\"form\":NaN}", "\xff\xfe", "{}x", "{\"x\":1e999}"}) {
    const auto parsed = parse_description(text, "a.exr");
    REQUIRE(!parsed);
    CHECK(parsed.error().message ==
          "a.exr: its `spm` attribute is not a JSON object of at most 64 levels; bake it again");
  }
}

}  // namespace asset_json_test
