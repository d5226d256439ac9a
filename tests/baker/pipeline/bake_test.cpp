// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/bake.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "bake_support.hpp"
#include "baker/base/bake_error.hpp"
#include "baker/cast/cast.hpp"
#include "baker/verify/answer_shares.hpp"
#include "common/base/random.hpp"
#include "common/paper/paper_force.hpp"
#include "common/query/query.hpp"

namespace spm::baker::bake_test {
namespace {

BakeOptions full(std::size_t planes, std::uint32_t resolution = 17) {
  BakeOptions options;
  options.form = AssetForm::full;
  options.planes = planes;
  options.resolution = resolution;
  return options;
}

bool same(const Asset& a, const Asset& b) {
  if (a.maps.size() != b.maps.size() || a.triangles != b.triangles ||
      a.octree.words != b.octree.words || a.octree.lists != b.octree.lists ||
      a.octree.triangles != b.octree.triangles || a.octree.corners != b.octree.corners ||
      a.octree.sides != b.octree.sides || a.octree.root_words != b.octree.root_words ||
      a.atlas.heights != b.atlas.heights || a.atlas.charts.size() != b.atlas.charts.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.maps.size(); ++i) {
    if (a.maps[i].samples != b.maps[i].samples || a.maps[i].mask != b.maps[i].mask) return false;
  }
  return a.grid.index == b.grid.index && a.grid.records == b.grid.records &&
         a.metadata.options == b.metadata.options;
}

/// What the file holds, but for its header.
double bytes_of(const Asset& asset) {
  const OctreeData& octree = asset.octree;
  const auto size = [](const auto& words) { return words.size() * sizeof(words[0]); };
  return static_cast<double>(size(octree.root_words) + size(octree.words) + size(octree.lists) +
                             size(octree.corners) + size(octree.triangles) + size(octree.sides) +
                             size(asset.atlas.heights));
}

TEST_CASE("The result does not depend on the number of threads") {
  for (const AssetForm form : {AssetForm::sparse, AssetForm::full}) {
    BakeOptions options = form == AssetForm::full ? full(40) : BakeOptions{};
    options.threads = 1;
    const Mesh mesh = test::mesh_of(test::torus(0.025, 0.0095, 40, 20));
    const Asset one = bake(mesh, options).asset;
    options.threads = 2;
    CHECK(same(one, bake(mesh, options).asset));
  }
}

TEST_CASE("A coarser tolerance costs no more bytes") {
  // Thin sheets, a fine mesh that is not smooth, and a crease.
  test::Shape lens = test::sphere(0.015, 4);
  for (Vector3& vertex : lens.vertices) vertex[2] *= 0.08;
  test::Shape uneven = test::sphere(0.015, 4);
  for (std::uint64_t i = 0; i < uneven.vertices.size(); ++i) {
    uneven.vertices[i] *= 1 + 5e-3 * random_unit(3, i);
  }
  // An octree may spend bytes on speed: so it may be a little larger than a slower one, and small
  // ones are as fast as can be.
  constexpr double spent = 1.14, least = 10'000;
  for (const test::Shape& shape : {lens, uneven, test::wedge(0.1, 0.02)}) {
    std::vector<double> bytes;
    for (const double tolerance : {50e-6, 100e-6, 130e-6, 200e-6, 400e-6, 0.8e-3, 1e-3}) {
      BakeOptions options;
      options.tolerance = tolerance;
      bytes.push_back(bytes_of(bake(test::mesh_of(shape), options).asset));
      INFO(tolerance * 1e6 << " um: " << bytes.back());
      if (bytes.size() == 1) continue;
      CHECK(bytes.back() <= std::max(least, spent * bytes[bytes.size() - 2]));
    }
    // Beyond four tenths of the band nothing changes.
    CHECK(bytes[6] == bytes[5]);
  }
}

TEST_CASE("A box is answered by few heights on its faces") {
  const BakeResult baked = bake(test::mesh_of(test::box({0.02, 0.03, 0.04})), {});
  const SharesOfPlaces shares = shares_of_places(tables_of(baked.asset).view());
  for (const AnswerShares& of : {shares.band, shares.surface}) {
    CHECK(of.one_map + of.two_maps + of.triangles == Approx(1));
    CHECK(of.one_map + of.two_maps > 0.2);
  }
  CHECK(baked.asset.atlas.heights.size() < 2000);
}

TEST_CASE("The shares of answers are those of places drawn at random") {
  const Mesh mesh = test::mesh_of(test::torus(0.025, 0.0095, 40, 20));
  const Asset asset = bake(mesh, {}).asset;
  const AssetTables tables = tables_of(asset);
  const SharesOfPlaces shares = shares_of_places(tables.view());
  AnswerShares band, surface;
  double in_band = 0, at_surface = 0;
  for (std::uint64_t i = 0; i < 400'000; ++i) {
    const Vector3 place(random_unit(43, 3 * i), random_unit(43, 3 * i + 1),
                        random_unit(43, 3 * i + 2));
    const Vector3 low = mesh.box_min - Vector3::Constant(1e-3);
    const Vector3 high = mesh.box_max + Vector3::Constant(1e-3);
    const Answer answer = query_point(tables.view(), low + place.cwiseProduct(high - low));
    if (answer.status != Status::exact) continue;
    const auto count = [&answer](AnswerShares& of, double& all) {
      ++all;
      of.one_map += answer.source == Source::map ? 1 : 0;
      of.triangles += answer.source == Source::triangles ? 1 : 0;
    };
    count(band, in_band);
    if (std::abs(answer.distance) < 1e-4) count(surface, at_surface);
  }
  REQUIRE(at_surface > 5000);
  CHECK(shares.band.one_map + shares.band.two_maps == Approx(band.one_map / in_band).margin(0.01));
  CHECK(shares.band.triangles == Approx(band.triangles / in_band).margin(0.01));
  CHECK(shares.surface.one_map + shares.surface.two_maps ==
        Approx(surface.one_map / at_surface).margin(0.03));
  CHECK(shares.surface.triangles == Approx(surface.triangles / at_surface).margin(0.03));
}

TEST_CASE("A full map covers its plane's own region") {
  const Mesh mesh = test::mesh_of(test::torus(0.025, 0.0095, 40, 20));
  const Asset asset = bake(mesh, full(60)).asset;
  const AssetTables tables = tables_of(asset);
  std::size_t tried = 0;
  for (std::uint64_t i = 0; tried < 3000; ++i) {
    const Vector3 place(random_unit(41, 3 * i), random_unit(41, 3 * i + 1),
                        random_unit(41, 3 * i + 2));
    const Vector3 point = mesh.box_min + place.cwiseProduct(mesh.box_max - mesh.box_min);
    const std::size_t closest = closest_support_plane(tables.view(), point);
    const PlaneCoordinates coordinates = project_on_plane(asset.planes[closest], point);
    if (coordinates.depth < 0) continue;
    ++tried;
    CHECK(locate(tables.view().maps[closest], coordinates.eta, coordinates.omega).inside);
  }
}

TEST_CASE("Every sample of a full map is the first crossing of its own ray, every layer the next") {
  const test::Shape shape = test::torus(0.025, 0.0095, 40, 20);
  const Mesh mesh = test::mesh_of(shape);
  const Asset asset = bake(mesh, full(30)).asset;
  const Caster caster(test::surface_of(shape));
  Column column;
  std::uint32_t most = 0;
  for (const MapData& map : asset.maps) {
    for (std::uint32_t i = 0; i < map.columns * map.rows; i += 7) {
      const std::uint32_t row = i / map.columns;
      caster.cast(asset.planes[map.plane], i % map.columns * map.spacing, row * map.spacing,
                  column);
      for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
        const float stored = map.samples[layer * map.columns * map.rows + i];
        const float cast = layer < column.crossings.size()
                               ? static_cast<float>(column.crossings[layer].depth)
                               : no_hit;
        CHECK(stored == cast);
      }
    }
    most = std::max(most, map.layers);
  }
  CHECK(most >= 4);
  CHECK(asset.metadata.layers_max >= 4);
}

TEST_CASE("Scalar and limited maps keep only the layers asked for") {
  const Mesh mesh = test::mesh_of(test::torus(0.025, 0.0095, 40, 20));
  BakeOptions options = full(30);
  options.layers = Layers::scalar;
  for (const MapData& map : bake(mesh, options).asset.maps) CHECK(map.layers == 1);
  options.layers = Layers::limited;
  options.layer_limit = 3;
  for (const MapData& map : bake(mesh, options).asset.maps) CHECK(map.layers <= 3);
}

TEST_CASE("A thin plate keeps its two sides") {
  const Vector3 size(0.06, 0.06, 0.0005);
  const BakeResult result = bake(test::mesh_of(test::plate(size)), BakeOptions{});
  const AssetTables tables = tables_of(result.asset);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const double z = 0.0007 * (random_unit(51, 3 * i) - 0.5);
    const Vector3 point(0.05 * (random_unit(51, 3 * i + 1) - 0.5),
                        0.05 * (random_unit(51, 3 * i + 2) - 0.5), z);
    const Answer answer = query_point(tables.view(), point);
    CHECK(answer.distance == Approx(std::abs(z) - 0.00025).margin(6e-5));
    if (std::abs(z) > 1e-4) CHECK(answer.normal.z() * z > 0);
  }
}

TEST_CASE("A sealed cavity is left out, and a query into it says so") {
  const test::Shape shell =
      test::merged(test::sphere(0.029, 4), test::turned_inside_out(test::sphere(0.02, 4)));
  Mesh mesh = test::mesh_of(shell);
  mesh.components = 2;
  const BakeResult result = bake(mesh, BakeOptions{});
  const AssetTables tables = tables_of(result.asset);
  const Answer wall = query_point(tables.view(), {0.021, 0, 0});
  CHECK(wall.status == Status::pruned);
  CHECK(std::isnan(wall.distance));
  CHECK(query_point(tables.view(), {0.0285, 0, 0}).distance == Approx(-0.0005).margin(1e-4));
  REQUIRE(result.report.pruned.size() == 1);
  CHECK(result.report.pruned.front().rule == "unreachable");
  CHECK(result.report.pruned.front().bytes > 0);
}

TEST_CASE("A cavity's wall pushes into a cavity that a path leads to") {
  // A cup: a box with a deep square well in its top.
  test::Shape cup = test::box({0.06, 0.06, 0.01});
  for (const double side : {-1.0, 1.0}) {
    cup = test::merged(cup, test::moved(test::box({0.06, 0.02, 0.03}), {0, 0.02 * side, 0.015}));
    cup = test::merged(cup, test::moved(test::box({0.02, 0.06, 0.03}), {0.02 * side, 0, 0.015}));
  }
  Mesh mesh = test::mesh_of(cup);
  mesh.components = 5;
  const BakeResult result = bake(mesh, BakeOptions{});
  const AssetTables tables = tables_of(result.asset);
  const Answer wall = query_point(tables.view(), {0.011, 0.002, 0.02});
  CHECK(wall.distance == Approx(-0.001).margin(1e-4));
  CHECK(wall.normal.x() < -0.99);
  CHECK(query_point(tables.view(), {0.0097, 0.002, 0.02}).distance == Approx(0.0003).margin(1e-4));
}

TEST_CASE("The partition answers every point of the band on a comb with deep grooves") {
  test::Shape comb = test::box({0.06, 0.03, 0.01});
  for (int tooth = 0; tooth < 5; ++tooth) {
    comb = test::merged(
        comb, test::moved(test::box({0.004, 0.03, 0.03}), {-0.024 + 0.012 * tooth, 0, 0.019}));
  }
  Mesh mesh = test::mesh_of(comb);
  mesh.components = 6;
  const BakeResult result = bake(mesh, BakeOptions{});
  const AssetTables tables = tables_of(result.asset);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    // Around the sides of the middle tooth, from the groove's floor to the tip.
    const double z = 0.006 + 0.027 * random_unit(61, 3 * i);
    const double depth = -0.0015 + 0.0019 * random_unit(61, 3 * i + 1);
    const Vector3 point(0.002 + depth, 0.02 * (random_unit(61, 3 * i + 2) - 0.5), z);
    const Answer answer = query_point(tables.view(), point);
    const double floor = z - 0.005, tip = z - 0.034;
    const double exact = depth > 0 ? std::min(depth, floor) : std::max(depth, tip);
    CHECK(answer.distance == Approx(exact).margin(1e-4));
  }
}

TEST_CASE("Options that cannot be met are refused as usage errors") {
  const Mesh mesh = test::mesh_of(test::box({0.05, 0.05, 0.05}));
  const auto code = [&](const BakeOptions& options) {
    try {
      (void)bake(mesh, options);
    } catch (const BakeError& error) {
      return error.code();
    }
    return ExitCode::done;
  };
  BakeOptions options;
  options.max_depth = 0;
  CHECK(code(options) == ExitCode::usage);
  options = {};
  options.probe_radius = 0.002;
  options.margin = 0.001;
  CHECK(code(options) == ExitCode::usage);
  options = full(6, 1);
  CHECK(code(options) == ExitCode::usage);
  options = full(6, 4097);
  options.kind = PlaneKind::vertex;
  options.planes = 1000;
  CHECK(code(options) == ExitCode::usage);
  options = full(6);
  options.layers = Layers::limited;
  CHECK(code(options) == ExitCode::usage);
}

}  // namespace
}  // namespace spm::baker::bake_test
