// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <limits>

#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::distance_map_test {
namespace {

using test::MapByHand;

MapByHand plane_map(double a, double b, double c) {
  MapByHand made = test::map_by_hand(
      0, 5, 4, 1, -0.01, 0.02, 0.005,
      [=](std::uint32_t, double eta, double omega) { return a + b * eta + c * omega; });
  made.map.samples = made.samples.data();
  made.map.layer_offsets = made.offsets.data();
  made.map.mask = made.mask.data();
  return made;
}

TEST_CASE("A map of a tilted plane gives its height and slopes everywhere") {
  const MapByHand made = plane_map(0.03, 0.4, -0.7);
  for (const double eta : {-0.01, -0.0043, 0.0099}) {
    for (const double omega : {0.02, 0.0271, 0.0349}) {
      const MapCell cell = locate(made.map, eta, omega);
      REQUIRE(cell.inside);
      const Height height = height_at(made.map, 0, cell);
      CHECK(height.value == Approx(0.03 + 0.4 * eta - 0.7 * omega).margin(1e-8));
      CHECK(height.d_eta == Approx(0.4).margin(2e-6));
      CHECK(height.d_omega == Approx(-0.7).margin(2e-6));
    }
  }
}

TEST_CASE("Places beyond a map are outside, NaN and infinity too") {
  const MapByHand made = plane_map(0, 0, 0);
  const double bad[] = {-0.0101, 0.0101, std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(), -1e300};
  for (const double eta : bad) {
    const MapCell cell = locate(made.map, eta, 0.025);
    CHECK_FALSE(cell.inside);
    CHECK(cell.column + 1 < made.map.columns);
    CHECK(cell.fx >= 0);
    CHECK(cell.fx <= 1);
  }
}

TEST_CASE("The surface of eq. 4 and the normal of eq. 5 are those of a tilted plane") {
  const SupportPlane plane = plane_with_normal({0.1, 0.2, 0.3}, Vector3(1, 2, -2).normalized());
  const double b = 0.4, c = -0.7;
  const auto surface = [&](double eta, double omega) {
    return reconstructed_surface(plane, eta, omega, 0.03 + b * eta + c * omega);
  };
  const Vector3 exact =
      (surface(1, 0) - surface(0, 0)).cross(surface(0, 1) - surface(0, 0)).normalized();
  CHECK((surface_normal(plane, b, c).normalized() - exact).norm() < 1e-14);
  CHECK(support_plane_depth(plane, surface(0.2, 0.1)) == Approx(0.03 + b * 0.2 + c * 0.1));
}

TEST_CASE("The tangents of eq. 7 and 8 are eq. 6 for a normal that does not vary") {
  const SupportPlane plane = plane_with_normal(Vector3::Zero(), Vector3(3, -1, 2).normalized());
  const Vector3 constant = Vector3::Zero();
  CHECK((tangent_eta(plane, 0.3) - tangent_general(plane.u, 0.3, plane.n, 0.05, constant)).norm() <
        1e-15);
  CHECK((tangent_omega(plane, -2) - tangent_general(plane.v, -2, plane.n, 0.05, constant)).norm() <
        1e-15);
}

TEST_CASE("A mask has one bit for each cell of each layer") {
  MapByHand made = test::map_by_hand(0, 4, 3, 2, 0, 0, 1, [](auto, auto, auto) { return 0.0; });
  made.mask.assign(mask_words(4, 3, 2), 0);
  made.map.mask = made.mask.data();
  const std::uint32_t bit = 6 + 1 * 3 + 2;  // layer 1, row 1, column 2
  made.mask[0] = 1U << bit;
  for (std::uint32_t layer = 0; layer < 2; ++layer) {
    for (std::uint32_t row = 0; row < 2; ++row) {
      for (std::uint32_t column = 0; column < 3; ++column) {
        CHECK(made.map.cell_valid(layer, column, row) == (layer == 1 && row == 1 && column == 2));
      }
    }
  }
}

}  // namespace
}  // namespace spm::distance_map_test
