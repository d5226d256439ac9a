// SPDX-License-Identifier: Apache-2.0
#include "common/paper/probe_footprint.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <set>
#include <utility>

#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::probe_footprint_test {
namespace {

using Places = std::set<std::pair<std::int64_t, std::int64_t>>;

/// A map by its measures alone: a footprint reads no sample.
DistanceMap map_of(std::uint32_t columns, std::uint32_t rows, double spacing) {
  DistanceMap map;
  map.columns = columns;
  map.rows = rows;
  map.spacing = spacing;
  map.eta0 = -0.5 * spacing * columns;
  map.omega0 = -0.4 * spacing * rows;
  return map;
}

Places places_of(const ProbeFootprint& footprint) {
  Places places;
  const LatticeRange rows = footprint.rows();
  for (std::int64_t row = rows.first; row <= rows.last; ++row) {
    const LatticeRange columns = footprint.columns(row);
    for (std::int64_t column = columns.first; column <= columns.last; ++column) {
      places.emplace(column, row);
    }
  }
  return places;
}

Vector3 turned(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3(normal(random), normal(random), normal(random)).normalized();
}

TEST_CASE("A footprint has each place of its lattice whose ray meets the probe, and few others") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  const SupportPlane plane = plane_with_normal({0.01, -0.02, 0.03}, turned(random));
  std::size_t met = 0, seen = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const DistanceMap map = map_of(40, 30, 1e-3);
    const Vector3 middle =
        support_plane_point(plane, 0.04 * (unit(random) - 0.5), 0.03 * (unit(random) - 0.4)) -
        0.01 * unit(random) * plane.n;
    const Vector3 half = (trial % 2 == 0 ? 0.0 : 0.008 * unit(random)) * turned(random);
    const CapsuleProbe probe(middle - half, middle + half, 1e-4 + 0.006 * unit(random));
    const ProbeFootprint footprint(map, plane, probe);
    const Places places = places_of(footprint);
    const double step = footprint.step() * map.spacing;
    const auto last_column = std::floor(39 * map.spacing / step + 1e-6);
    const auto last_row = std::floor(29 * map.spacing / step + 1e-6);
    for (std::int64_t row = 0; row <= static_cast<std::int64_t>(last_row); ++row) {
      for (std::int64_t column = 0; column <= static_cast<std::int64_t>(last_column); ++column) {
        const Vector3 place =
            support_plane_point(plane, map.eta0 + static_cast<double>(column) * step,
                                map.omega0 + static_cast<double>(row) * step);
        const bool hit = probe.span(place, -plane.n).hit();
        if (hit) REQUIRE(places.count({column, row}) == 1);
        met += hit ? 1 : 0;
      }
    }
    seen += places.size();
  }
  CHECK(met > 10000);
  CHECK(static_cast<double>(seen) <= 1.001 * static_cast<double>(met));
}

TEST_CASE("However large a probe or a map is, the places are bounded") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t most = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const auto size = [&](double low, double high) {
      return low * std::pow(high / low, unit(random));
    };
    const DistanceMap map = map_of(static_cast<std::uint32_t>(size(2, 4097)),
                                   static_cast<std::uint32_t>(size(2, 4097)), size(1e-6, 1e-2));
    const SupportPlane plane = plane_with_normal({0, 0, 0}, turned(random));
    const Vector3 half = size(1e-9, 10) * turned(random);
    const CapsuleProbe probe(-half, half, size(1e-9, 10));
    most = std::max(most, places_of(ProbeFootprint(map, plane, probe)).size());
  }
  CHECK(most > most_probe_samples / 2);
  CHECK(most <= 3 * most_probe_samples + 2);
}

TEST_CASE("A probe smaller than a map's samples is measured between them, at enough places") {
  const DistanceMap map = map_of(9, 9, 1e-2);
  const SupportPlane plane = plane_with_normal({0, 0, 0}, Vector3::UnitZ());
  for (const double radius : {1e-6, 5e-4, 1e-3, 3e-3, 2e-2}) {
    for (const double at : {0.0, 0.0013, 0.0037}) {
      const Places places =
          places_of(ProbeFootprint(map, plane, SphereProbe(Vector3(at, -at, -0.01), radius)));
      INFO(radius << " " << at << ": " << places.size());
      CHECK(static_cast<double>(places.size()) >= 0.85 * 254);
    }
  }
}

TEST_CASE("The lattice does not move with the hand, and its cells hold its places") {
  const DistanceMap map = map_of(200, 300, 1e-4);
  const SupportPlane plane = plane_with_normal({0, 0, 0}, Vector3::UnitZ());
  for (const double radius : {2e-4, 2e-3, 8e-3}) {
    const ProbeFootprint here(map, plane, SphereProbe({0, 0, 0}, radius));
    const ProbeFootprint there(map, plane, SphereProbe({1.234e-4, 3.3e-5, 0}, radius));
    CHECK(here.step() == there.step());
    for (const auto& [column, row] : places_of(here)) {
      const MapCell cell = here.cell(column, row);
      REQUIRE(cell.inside);
      REQUIRE(cell.column + cell.fx ==
              Approx(static_cast<double>(column) * here.step()).margin(1e-9));
      REQUIRE(cell.row + cell.fy == Approx(static_cast<double>(row) * here.step()).margin(1e-9));
    }
  }
}

}  // namespace
}  // namespace spm::probe_footprint_test
