// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/render.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "baker/verify/direction_picture.hpp"
#include "baker/verify/structure_picture.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::render_test {
namespace {

constexpr std::uint32_t side = 40;

Colour pixel(const Picture& picture, std::uint32_t column, std::uint32_t row) {
  Colour colour{};
  for (std::size_t k = 0; k < 3; ++k) {
    colour[k] = picture.pixels[std::size_t{3} * (row * picture.width + column) + k] / 255.0;
  }
  return colour;
}

bool same(const Colour& a, const Colour& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(a[k] - b[k]) > 0.01) return false;
  }
  return true;
}

/// True where a pixel is this colour in any light.
bool lit(const Colour& pixel, const Colour& colour) {
  const double light = *std::max_element(pixel.begin(), pixel.end()) /
                       *std::max_element(colour.begin(), colour.end());
  return light > 0.3 && same(pixel, {light * colour[0], light * colour[1], light * colour[2]});
}

/// How many pixels are one of these colours in any light.
int count_lit(const Picture& picture, const std::vector<Colour>& colours) {
  int count = 0;
  for (std::uint32_t i = 0; i < picture.width * picture.height; ++i) {
    const Colour here = pixel(picture, i % picture.width, i / picture.width);
    count += std::any_of(colours.begin(), colours.end(),
                         [&](const Colour& colour) { return lit(here, colour); })
                 ? 1
                 : 0;
  }
  return count;
}

/// The colour of an error beyond the end of the colours.
Colour beyond() { return colour_of_error(2, 1); }

/// A box as an exact asset knows it, and pictures of its errors against a box that is moved.
struct BoxPictures {
  test::Shape box = test::box({0.02, 0.02, 0.02});
  BakeResult baked;
  AssetTables tables;

  BoxPictures() {
    BakeOptions options;
    options.tolerance = 1e-4;
    options.max_depth = 0.002;
    baked = bake(test::mesh_of(box), options);
    tables = tables_of(baked.asset);
  }

  [[nodiscard]] Picture on_surface(const Vector3& moved, const Vector3& toward) const {
    const test::Shape other = test::moved(box, moved);
    const ExactSurface exact(test::mesh_of(other));
    const Caster surface(test::surface_of(other));
    return error_on_surface(surface, {exact, tables.view(), tables.view().band, 1e-4},
                            {Vector3::Zero(), toward, 0.03}, side);
  }
};

TEST_CASE("A render shows a surface where it is and nothing beside it") {
  const Caster ball(test::surface_of(test::sphere(0.01, 3)));
  const Picture picture = render(ball, {Vector3::Zero(), Vector3::UnitZ(), 0.03}, side);
  REQUIRE(picture.width == side);
  const Colour nothing = pixel(picture, 0, 0);
  CHECK(pixel(picture, side / 2, side / 2)[0] > 2 * nothing[0]);
  // The ball takes two thirds of the window.
  CHECK(same(pixel(picture, side / 2, 3), nothing));
  CHECK_FALSE(same(pixel(picture, side / 2, 8), nothing));
  // Lit from the upper left.
  CHECK(pixel(picture, 13, 13)[0] > pixel(picture, 27, 27)[0]);
}

TEST_CASE("A window on a box shows all of it") {
  const Window window = whole_of({0, 0, 0}, {0.01, 0.02, 0.03}, Vector3::UnitX());
  CHECK((window.middle - Vector3(0.005, 0.01, 0.015)).norm() < 1e-12);
  // Seen along x, y and z remain.
  CHECK(window.edge > 0.03);
  CHECK(window.edge < 0.036);
  const Window askew = whole_of({0, 0, 0}, {0.01, 0.02, 0.03}, Vector3(0, 1, 1).normalized());
  CHECK(askew.edge > Vector3(0.02, 0.03, 0).sum() / std::sqrt(2.0));
}

TEST_CASE("The exported surface of an asset looks like the mesh") {
  const BoxPictures box;
  const Caster known = caster_of(contour_mesh(box.tables.view(), 40));
  const Window window{Vector3::Zero(), Vector3(1, 2, 3).normalized(), 0.04};
  const Picture one = render(known, window, side);
  const Picture other = render(Caster(test::surface_of(box.box)), window, side);
  int differ = 0;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    differ += same(pixel(one, i % side, i / side), pixel(other, i % side, i / side)) ? 0 : 1;
  }
  CHECK(differ < 20);
}

TEST_CASE("Error pictures tell no error from one beyond the tolerance") {
  const BoxPictures box;
  const Picture exact = box.on_surface(Vector3::Zero(), Vector3::UnitZ());
  const Colour middle = pixel(exact, side / 2, side / 2);
  CHECK(middle[2] > middle[0]);
  CHECK(middle[2] > middle[1]);
  const Picture moved = box.on_surface({0, 0, 2e-4}, Vector3::UnitZ());
  const Colour wrong = pixel(moved, side / 2, side / 2);
  CHECK(wrong[0] > 3 * wrong[1]);
  CHECK(wrong[0] > 3 * wrong[2]);
}

TEST_CASE("A section shows the band about the surface and nothing beyond it") {
  const BoxPictures box;
  const ExactSurface exact(test::mesh_of(box.box));
  const Picture picture = error_in_section({exact, box.tables.view(), box.tables.view().band, 1e-4},
                                           {Vector3::Zero(), Vector3::UnitZ(), 0.03}, 300);
  const Colour nothing = pixel(picture, 0, 0);
  CHECK(same(pixel(picture, 150, 150), nothing));    // deeper than the band
  CHECK(same(pixel(picture, 250, 150), {1, 1, 1}));  // the surface, at 10 mm
  CHECK_FALSE(same(pixel(picture, 240, 150), nothing));
}

TEST_CASE("A structure picture tells the faces of a box from its edges") {
  namespace colours = structure_colours;
  const BoxPictures box;
  const Caster surface(test::surface_of(box.box));
  // A pixel is 50 um; an edge of the box is 10 mm from the middle.
  const Picture face = structure_on_surface(surface, box.tables.view(),
                                            {Vector3::Zero(), Vector3::UnitZ(), 0.004}, 80);
  CHECK(count_lit(face, {colours::one_map}) == 80 * 80);
  const Picture corner = structure_on_surface(surface, box.tables.view(),
                                              {{0.01, 0.01, 0.01}, Vector3::UnitZ(), 0.008}, 160);
  CHECK(count_lit(corner, {colours::one_map}) > 100);
  CHECK(count_lit(corner, {colours::two_maps, colours::list, colours::long_list}) > 100);
}

TEST_CASE("The colours of a structure picture are those of the leaves that answer") {
  namespace colours = structure_colours;
  const BoxPictures box;
  const AssetView view = box.tables.view();
  const ExactSurface exact(test::mesh_of(box.box));
  const Window window{{0.01, 0.01, 0.0001}, Vector3::UnitZ(), 0.008};
  const Picture picture = structure_in_section(exact, view, window, 160);
  int borders = 0, kinds = 0, wrong = 0;
  for (std::uint32_t i = 0; i < 160 * 160; ++i) {
    const std::uint32_t column = i % 160, row = i / 160;
    const Vector3 place = window.middle + window.edge * Vector3((column + 0.5) / 160 - 0.5,
                                                                0.5 - (row + 0.5) / 160, 0);
    const Colour here = pixel(picture, column, row);
    const Source source = query_point(view, place).source;
    if (source == Source::none || same(here, {1, 1, 1})) continue;
    const bool maps = lit(here, colours::one_map) || lit(here, colours::two_maps);
    const bool list = lit(here, colours::list) || lit(here, colours::long_list);
    wrong += (source == Source::map ? maps : list) ? 0 : 1;
    kinds |= source == Source::map ? 1 : source == Source::triangles ? 2 : 0;
    borders += same(here, colours::one_map) || !lit(here, colours::one_map) ? 0 : 1;
  }
  CHECK(wrong == 0);
  CHECK(kinds == 3);
  CHECK(borders > 10);
}

TEST_CASE("A structure picture of a full asset tells maps from triangles") {
  namespace colours = structure_colours;
  const test::Shape ball = test::sphere(0.01, 3);
  BakeOptions options;
  options.form = AssetForm::full;
  options.max_depth = 0.002;
  const BakeResult baked = bake(test::mesh_of(ball), options);
  const AssetTables tables = tables_of(baked.asset);
  const Picture picture = structure_on_surface(Caster(test::surface_of(ball)), tables.view(),
                                               {Vector3::Zero(), Vector3::UnitZ(), 0.03}, side);
  CHECK(lit(pixel(picture, side / 2, side / 2), colours::one_map));
  CHECK(count_lit(picture, {colours::one_map, colours::list}) > 400);
}

TEST_CASE("A direction picture of a sphere has no error, and one of a moved sphere has") {
  const test::Shape ball = test::sphere(0.01, 4);
  BakeOptions options;
  options.tolerance = 2e-5;
  options.max_depth = 0.002;
  const BakeResult baked = bake(test::mesh_of(ball), options);
  const AssetTables tables = tables_of(baked.asset);
  const auto picture_of = [&](const Vector3& offset) {
    const test::Shape other = test::moved(ball, offset);
    const ExactSurface exact(test::mesh_of(other));
    return direction_beside_surface(Caster(test::surface_of(other)),
                                    {exact, tables.view(), 2e-5, 0.15}, -2.5e-4,
                                    {Vector3::Zero(), Vector3::UnitZ(), 0.03}, side);
  };
  const Picture right = picture_of(Vector3::Zero());
  CHECK(count_lit(right, {beyond()}) == 0);
  const Colour middle = pixel(right, side / 2, side / 2);
  CHECK(middle[2] > middle[0]);
  CHECK(count_lit(picture_of({0.0018, 0, 0}), {beyond()}) > 20);
}

TEST_CASE("A direction picture is grey where several faces are equally near") {
  const BoxPictures box;
  const ExactSurface exact(test::mesh_of(box.box));
  // A pixel is 50 um. Half a millimetre below a face the next one is as near half a millimetre
  // from the edge.
  const Picture picture = direction_beside_surface(Caster(test::surface_of(box.box)),
                                                   {exact, box.tables.view(), 1e-4, 0.1}, -5e-4,
                                                   {{0.01, 0, 0.01}, Vector3::UnitZ(), 0.004}, 80);
  CHECK(lit(pixel(picture, 40 - 10, 40), not_judged));
  const Colour away = pixel(picture, 40 - 30, 40);
  CHECK_FALSE(lit(away, not_judged));
  CHECK_FALSE(lit(away, beyond()));
}

}  // namespace
}  // namespace spm::baker::render_test
