// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict of `verify`: in words, in JSON, as points and as an exit code.
#include <png.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "baker/commands/commands.hpp"
#include "baker/commands/verify_text.hpp"
#include "baker/mesh/load.hpp"
#include "baker/pipeline/bake.hpp"
#include "baker/surface/outer_surface.hpp"
#include "baker/verify/render.hpp"
#include "baker/verify/verify_pictures.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset_writer.hpp"
#include "tests/baker/mesh/mesh_support.hpp"
#include "tests/baker/verify/spoilt_asset.hpp"
#include "tests/support/shapes.hpp"

namespace spm::baker::verify_command_test {
namespace {

using Json = nlohmann::ordered_json;

constexpr double radius = 0.02;
constexpr double spoilt_by = 300e-6;

Picture read_png(const std::string& bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) != 0);
  image.format = PNG_FORMAT_RGB;
  Picture picture{image.width, image.height, {}};
  picture.pixels.resize(PNG_IMAGE_SIZE(image));
  REQUIRE(png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr) != 0);
  return picture;
}

/// Captures one of the standard streams while it lives.
class Captured {
 public:
  explicit Captured(std::ostream& stream) : stream_(stream), before_(stream.rdbuf(text_.rdbuf())) {}
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;
  ~Captured() { stream_.rdbuf(before_); }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostream& stream_;
  std::ostringstream text_;
  std::streambuf* before_;
};

struct Said {
  int code = 0;
  std::string text;
  [[nodiscard]] Json json() const { return Json::parse(text); }
  [[nodiscard]] std::string last_line() const {
    const std::size_t end = text.rfind('\n');
    return text.substr(text.rfind('\n', end - 1) + 1, end - text.rfind('\n', end - 1) - 1);
  }
};

/// A baked sphere in a folder, and `verify` of it.
class Baked {
 public:
  explicit Baked(int subdivisions = 3) {
    test::write_obj(test::sphere(radius, subdivisions), mesh_);
    BakeOptions options;
    options.tolerance = 100e-6;
    options.max_depth = 0.5e-3;
    asset = bake(load_mesh(mesh_, {}), options).asset;
    asset.metadata.tolerance_met = true;
  }

  /// Makes the largest distance map near the surface tell too little, and gives the middle of its
  /// cube.
  [[nodiscard]] Vector3 spoil() { return test::spoil_largest_map(asset, -spoilt_by).middle; }

  [[nodiscard]] Said verify(std::vector<std::string> options) const {
    REQUIRE(write_asset(asset, file_).has_value());
    CLI::App app;
    const Command command = add_verify_command(app);
    options.insert(options.begin(), {"verify", file_, mesh_});
    std::reverse(options.begin(), options.end());
    app.parse(options);
    const Captured out(std::cout);
    Said said;
    said.code = command.run();
    said.text = out.text();
    return said;
  }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_.path(name); }
  [[nodiscard]] const std::string& mesh() const { return mesh_; }

  Asset asset;

 private:
  test::TemporaryFolder folder_;
  std::string mesh_ = folder_.path("sphere.obj");
  std::string file_ = folder_.path("sphere.spm.exr");
};

/// A report of 1,000,000 places and 500,000 hard ones with nothing wrong.
VerifyReport faultless() {
  VerifyReport report;
  report.samples = 1'000'000;
  report.adversarial.samples = 500'000;
  report.tolerance = report.threshold = 50e-6;
  report.seed = 7;
  return report;
}

}  // namespace

TEST_CASE("A good asset is judged as kept with exit code 0, a spoilt map as missed with 10") {
  Baked baked;
  const Said good = baked.verify({"--samples", "20000"});
  CHECK(good.code == 0);
  CHECK(good.last_line() ==
        "verdict        kept: 0 of 20,000 places and 0 of 10,000 hard ones beyond 100 um, none "
        "unanswered, none on the wrong side (seed 1)");

  const Vector3 middle = baked.spoil();
  const Said spoilt = baked.verify({"--samples", "20000", "--seed", "3"});
  CHECK(spoilt.code == 10);
  CHECK_THAT(spoilt.last_line(), Catch::StartsWith("verdict        MISSED: "));
  CHECK_THAT(spoilt.last_line(), Catch::Contains(" of 20,000 places ("));
  CHECK_THAT(spoilt.last_line(), Catch::EndsWith("(seed 3)"));

  const Said told = baked.verify({"--samples", "20000", "--json", "--worst", "7"});
  CHECK(told.code == 10);
  const Json json = told.json();
  CHECK(json["passed"] == false);
  CHECK(json["tolerance_um"].get<double>() == Approx(100));
  CHECK(json["counts"]["beyond_tolerance"] > 0);
  REQUIRE(json["worst"].size() == 7);
  for (std::size_t i = 0; i < 7; ++i) {
    const Json& place = json["worst"][i];
    const std::vector<double> point = place["point"];
    INFO("place " << i);
    CHECK((Vector3(point[0], point[1], point[2]) - middle).norm() < 0.006);
    CHECK(place["error_um"] > 150);
    if (i > 0) CHECK(place["error_um"] <= json["worst"][i - 1]["error_um"]);
  }
}

TEST_CASE("verify --json has the keys of a verdict, and another seed judges other places") {
  const Baked baked;
  const Said said = baked.verify({"--samples", "2000", "--json"});
  CHECK(said.code == 0);
  const Json json = said.json();
  CHECK(json["passed"] == true);
  CHECK(json["seed"] == 1);
  CHECK(json["worst"].size() == 20);
  for (const char* key : {"unanswered", "wrong_side", "beyond_tolerance"}) {
    CHECK(json["counts"].at(key) == 0);
    CHECK(json["adversarial"]["counts"].at(key) == 0);
  }
  CHECK(json["not_judged"] == 0);
  const Json& jumps = json["jumps"];
  CHECK(jumps["borders"] > 0);
  CHECK(jumps["allowed_um"].get<double>() == Approx(200.01));
  for (const char* key : {"p50", "p99", "max"}) {
    CHECK(jumps["distance_um"].at(key) < 200);
    CHECK(jumps["direction_deg"].at(key) < 90);
  }
  const Json other = baked.verify({"--samples", "2000", "--seed", "2", "--json"}).json();
  CHECK(other["seed"] == 2);
  CHECK(other["worst"] != json["worst"]);
  CHECK(other["distance_error_um"] != json["distance_error_um"]);
}

TEST_CASE("verify writes the worst places as a PLY of as many points, and refuses a bad path") {
  const Baked baked;
  const std::string path = baked.path("worst.ply");
  CHECK(baked.verify({"--samples", "500", "--worst", "5", "--worst-ply", path}).code == 0);
  std::ifstream file(path);
  std::string line;
  std::size_t points = 0;
  bool body = false, declared = false;
  while (std::getline(file, line)) {
    points += body ? 1 : 0;
    declared = declared || line == "element vertex 5";
    body = body || line == "end_header";
  }
  CHECK(declared);
  CHECK(points == 5);
  CHECK(baked.verify({"--samples", "500", "--worst-ply", baked.path("none/worst.ply")}).code == 2);
}

TEST_CASE("The words of a verdict have counts, tolerance and seed") {
  VerifyReport report = faultless();
  CHECK(verdict_of(report) ==
        "kept: 0 of 1,000,000 places and 0 of 500,000 hard ones beyond 50 um, none unanswered, "
        "none on the wrong side (seed 7)");
  report.counts = {.unanswered = 1, .wrong_side = 1, .beyond_tolerance = 2, .pruned = 0};
  CHECK(verdict_of(report) ==
        "MISSED: 3 of 1,000,000 places (1 unanswered, 2 beyond 50 um, 1 on the wrong side) and 0 "
        "of 500,000 hard ones (seed 7)");
  report.tolerance.reset();
  CHECK(report.passed());
  CHECK_THAT(verdict_of(report),
             Catch::StartsWith("no promise: ") && Catch::Contains("3 of 1,000,000 places"));
}

TEST_CASE("Jumps that are too large are told, and miss the promise") {
  VerifyReport report = faultless();
  report.jumps.places = 5000;
  report.jumps.borders = 1200;
  report.jumps.allowed = 100e-6;
  report.jumps.beyond = 3;
  CHECK_FALSE(report.passed());
  CHECK_THAT(verdict_of(report),
             Catch::StartsWith("MISSED: ") &&
                 Catch::Contains("; 3 of 5,000 jumps between leaves beyond 100 um"));
  CHECK_THAT(describe(report),
             Catch::Contains("at 5,000 places on 1,200 borders of leaves, 3 beyond 100 um"));
}

TEST_CASE("What a verdict leaves out is told with its number of places") {
  VerifyReport report = faultless();
  report.counts.pruned = 250'000;
  report.pruned = 0.25;
  const std::string text = describe(report);
  CHECK_THAT(text, Catch::Contains("cut away       250,000 places (25.0 % of the samples)"));
  CHECK_THAT(verdict_of(report), Catch::StartsWith("kept: 0 of 750,000 places"));
}

TEST_CASE("A PLY of the worst places gives position, colour, error and finding of each") {
  const std::string text =
      to_ply({{{0.5, -0.25, 1}, -0.001, {}, Finding::unanswered, false},
              {{0.5, 0.25, 2}, 0.001, 75e-6, Finding::beyond_tolerance, true}});
  CHECK_THAT(text, Catch::StartsWith("ply\nformat ascii 1.0\n"));
  CHECK_THAT(text, Catch::Contains("element vertex 2\n"));
  CHECK_THAT(text, Catch::EndsWith("end_header\n0.5 -0.25 1 160 32 240 -1 0\n"
                                   "0.5 0.25 2 255 140 0 75 2\n"));
}

TEST_CASE("The pictures of verify show the mesh and the asset's surface") {
  const Baked baked(4);
  const Json json =
      baked.verify({"--samples", "100", "--json", "--png", baked.path("drawn")}).json();
  const std::vector<double> worst = json["worst"][0]["point"];
  const Mesh mesh = load_mesh(baked.mesh(), {});
  const Vector3 normal = ExactSurface(mesh).closest({worst[0], worst[1], worst[2]}).normal;
  const Window whole = whole_of(mesh.box_min, mesh.box_max, normal);
  const AssetTables tables = tables_of(baked.asset);
  const std::array<Picture, 2> both{
      render(Caster(outer_surface(mesh)), whole, 480),
      render(caster_of(contour_mesh(tables.view(), picture_cells)), whole, 480)};
  std::ifstream file(baked.path("drawn/surface.png"), std::ios::binary);
  const std::string drawn(std::istreambuf_iterator<char>(file), {});
  const Picture sheet = contact_sheet(both, 480);
  const Picture whole_file = read_png(drawn);
  REQUIRE(whole_file.width == sheet.width);
  REQUIRE(whole_file.height > sheet.height);  // with its legend below it
  CHECK(std::equal(sheet.pixels.begin(), sheet.pixels.end(), whole_file.pixels.begin()));
}

}  // namespace spm::baker::verify_command_test
