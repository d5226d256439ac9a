// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/verify/render.hpp"

#include <catch2/catch.hpp>

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
  CHECK(window.edge > Vector3(0.01, 0.02, 0.03).norm());
}

TEST_CASE("The exported surface of an asset looks like the mesh") {
  const BoxPictures box;
  const Caster known = caster_of(known_surface(box.tables.view()));
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

}  // namespace
}  // namespace spm::baker::render_test
