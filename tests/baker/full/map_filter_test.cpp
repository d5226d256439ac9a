// SPDX-License-Identifier: GPL-3.0-or-later
// Eq. 16 on distance maps, and its form that keeps edges.
#include "baker/full/map_filter.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/surface/distance_map.hpp"

namespace spm::baker::map_filter_test {
namespace {

constexpr std::uint32_t side = 61;
constexpr double spacing = 1e-4, sigma = 5e-4;
constexpr double degree = std::numbers::pi / 180;

/// A map of one layer; `depth` takes eta and omega from the middle, m.
template <class Depth>
MapData map_of(const Depth& depth) {
  MapData map;
  map.columns = map.rows = side;
  map.spacing = spacing;
  for (std::uint32_t row = 0; row < side; ++row) {
    for (std::uint32_t column = 0; column < side; ++column) {
      map.samples.push_back(
          static_cast<float>(depth(spacing * (column - 30.0), spacing * (row - 30.0))));
    }
  }
  return map;
}

float at(const MapData& map, std::uint32_t column, std::uint32_t row) {
  return map.samples[std::size_t{row} * side + column];
}

MapData filtered(MapData map, Smoothing kind, double angle = 0) {
  std::vector<MapData> maps{std::move(map)};
  filter_maps(maps, {kind, sigma, angle});
  return std::move(maps.front());
}

double roof(double eta, double /*omega*/) { return 0.01 + std::abs(eta); }

}  // namespace

TEST_CASE("A plane that leans stays where it is, at the border of its map too") {
  const MapData plane =
      map_of([](double eta, double omega) { return 0.02 + 0.7 * eta - 0.3 * omega; });
  for (const Smoothing kind : {Smoothing::gaussian, Smoothing::crease}) {
    const MapData result = filtered(plane, kind, 20 * degree);
    for (std::size_t i = 0; i < plane.samples.size(); ++i) {
      REQUIRE(result.samples[i] == Approx(plane.samples[i]).margin(1e-8));
    }
  }
}

TEST_CASE("A Gaussian rounds a roof by what its mean says") {
  const MapData result = filtered(map_of(roof), Smoothing::gaussian);
  // E |x| of a Gaussian.
  const double lower = sigma * std::sqrt(2 / std::numbers::pi);
  CHECK(at(result, 30, 30) - 0.01 == Approx(lower).epsilon(0.03));
  // Three sigmas from the edge nothing changes.
  CHECK(at(result, 46, 30) == Approx(roof(16 * spacing, 0)).margin(1e-6));
}

TEST_CASE("A crease angle keeps an edge that turns by more, and rounds one that turns by less") {
  // The two sides of the roof turn by 90 degrees.
  const MapData kept = filtered(map_of(roof), Smoothing::crease, 60 * degree);
  for (std::uint32_t column = 0; column < side; ++column) {
    CHECK(at(kept, column, 30) == Approx(roof(spacing * (column - 30.0), 0)).margin(2e-6));
  }
  const MapData rounded = filtered(map_of(roof), Smoothing::crease, 120 * degree);
  CHECK(at(rounded, 30, 30) > 0.01 + 0.5 * sigma);
}

TEST_CASE("A crease angle smooths the noise of a tessellation, and leaves its edge alone") {
  const auto noise = [](double eta, double omega) {
    return 4e-6 * std::sin(9e3 * eta + 7e3 * omega);
  };
  const MapData map =
      map_of([&](double eta, double omega) { return roof(eta, omega) + noise(eta, omega); });
  const MapData result = filtered(map, Smoothing::crease, 60 * degree);
  double before = 0, after = 0;
  for (std::uint32_t column = 0; column < side; ++column) {
    for (std::uint32_t row = 20; row < 40; ++row) {
      const double exact = roof(spacing * (column - 30.0), 0);
      before += std::abs(static_cast<double>(at(map, column, row)) - exact);
      after += std::abs(static_cast<double>(at(result, column, row)) - exact);
    }
  }
  CHECK(after < before / 2);
}

TEST_CASE("Neither what met nothing nor another sheet counts") {
  MapData map = map_of([](double eta, double /*omega*/) { return eta < 0 ? 0.01 : 0.02; });
  for (std::uint32_t row = 0; row < side; ++row) map.samples[std::size_t{row} * side + 10] = no_hit;
  const MapData result = filtered(map, Smoothing::gaussian);
  for (std::uint32_t row = 0; row < side; ++row) {
    for (std::uint32_t column = 0; column < side; ++column) {
      if (column == 10) {
        CHECK(std::isinf(at(result, column, row)));
      } else {
        CHECK(at(result, column, row) == Approx(column < 30 ? 0.01 : 0.02).margin(1e-8));
      }
    }
  }
}

TEST_CASE("Each layer of a map is filtered for itself") {
  MapData map = map_of(roof);
  const std::size_t count = map.samples.size();
  map.layers = 2;
  map.samples.insert(map.samples.end(), count, 0.03F);
  const MapData alone = filtered(map_of(roof), Smoothing::gaussian);
  const MapData both = filtered(map, Smoothing::gaussian);
  for (std::size_t i = 0; i < count; ++i) {
    REQUIRE(both.samples[i] == alone.samples[i]);
    REQUIRE(both.samples[count + i] == Approx(0.03).margin(1e-8));
  }
}

}  // namespace spm::baker::map_filter_test
