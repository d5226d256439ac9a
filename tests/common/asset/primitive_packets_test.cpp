// SPDX-License-Identifier: Apache-2.0
#include "common/asset/primitive_packets.hpp"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "common/index/packet_bounds.hpp"
#include "common/surface/closest_on_tile.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"
#include "tests/support/every_target.hpp"
#include "tests/support/random.hpp"

namespace spm::primitive_packets_test {
namespace {

using test::RandomTwister;

Vector3 vector_in(RandomTwister& random, double reach) {
  return {random.between(-reach, reach), random.between(-reach, reach),
          random.between(-reach, reach)};
}

std::array<float, 3> floats(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Triangles, some of them slivers and points, and where their corners are.
TrianglePacket random_triangles(RandomTwister& random,
                                std::vector<std::array<Vector3, 3>>& corners) {
  TrianglePacket packet;
  corners.clear();
  for (std::size_t lane = 0; lane < packet_width; ++lane) {
    const Vector3 a = vector_in(random, 0.01), side = vector_in(random, 0.003);
    const double thin = lane % 4 == 3 ? 1e-5 : 1;
    const Vector3 other =
        lane == 6 ? side : side * random.between(0, 1) + thin * vector_in(random, 0.003);
    put_triangle(packet, lane, {a, a + side, a + other});
    corners.push_back({a, a + side, a + other});
  }
  return packet;
}

/// The groups of a wavy tile of which some cells are left out and some clipped, places from 0.
struct TilePackets {
  test::TileByHand made;
  Tile tile;
  SupportPlane plane;
  std::vector<CellPacket> cells;
  std::vector<ClipPacket> clips;
};

TilePackets random_cells(RandomTwister& random) {
  constexpr float unit = 1e-6F;
  const double bend = random.between(-20, 20), ridge = random.between(0, 0.3);
  TilePackets packets{
      test::tile_by_hand(0, random.between(-0.02, 0.02), random.between(-0.02, 0.02), 1e-3F, unit,
                         [=](double eta, double omega) {
                           return bend * (eta * eta - omega * eta) + ridge * std::abs(omega) + 0.01;
                         }),
      {},
      plane_with_normal({0.01, -0.02, 0.03}, vector_in(random, 1).normalized()),
      {},
      {}};
  Tile& tile = packets.made.tile;
  tile.valid = random.bits() | random.bits();
  tile.clipped = tile.valid & random.bits() & random.bits();
  for (int k = 0; k < std::popcount(tile.clipped); ++k) {
    packets.made.clips.push_back(pack_clip({static_cast<float>(random.between(-127, 127)),
                                            static_cast<float>(random.between(-127, 127)),
                                            static_cast<float>(random.between(-30, 60))}));
  }
  packets.tile = packets.made.view(unit);
  for (std::uint32_t part = 0; part < tile_packets; ++part) {
    CellPacket packet = cell_packet(packets.tile, unit, packets.plane, part, Vector3::Zero());
    packets.clips.push_back(clip_packet(packets.tile, packet));
    packet.clips =
        part % 2 == 0 || tile.clipped != 0 ? static_cast<std::uint32_t>(packets.clips.size()) : 0;
    packets.cells.push_back(packet);
  }
  return packets;
}

Vector3 point_near(RandomTwister& random, const TilePackets& packets) {
  const double spacing = double{packets.tile.spacing};
  return support_plane_point(packets.plane, packets.tile.eta0 + random.between(-2, 10) * spacing,
                             packets.tile.omega0 + random.between(-2, 10) * spacing) -
         (packets.tile.base + random.between(-0.006, 0.006)) * packets.plane.n;
}

constexpr std::array<std::uint32_t, tile_packets> all_cells{0, 1, 2, 3, 4, 5, 6, 7};

struct alignas(64) Squares {
  std::array<float, (tile_packets + 3) * packet_width> values{};
};

template <std::size_t count>
PackedNumbers names(const std::array<std::uint32_t, count>& numbers) {
  return {numbers.data(), count, false};
}

/// The closest point on a tile that a unit of its groups names.
TileClosestPoint closest_point_of(const TilePackets& packets, const NearestPrimitive& unit,
                                  const Vector3& point) {
  return closest_point_on_cell(packets.cells[unit.which / packet_width], unit.which % packet_width,
                               point, unit.x, unit.y);
}

TEST_CASE("The nearest unit of a tile's groups is the closest point on the tile") {
  RandomTwister random(2);
  int found = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const TilePackets packets = random_cells(random);
    const Vector3 point = point_near(random, packets);
    const TileClosestPoint wanted =
        closest_on_tile(packets.tile, 1e-6F, packets.plane, point, 1.0F);
    const NearestPrimitive nearest =
        nearest_primitive({packets.cells, packets.clips, {}}, names(all_cells), floats(point));
    REQUIRE(nearest.is_found() == std::isfinite(wanted.distance));
    if (!std::isfinite(wanted.distance)) continue;
    ++found;
    // The margin covers a cell's twist, and places that are beyond two sides of it.
    CHECK(std::sqrt(double{nearest.square}) == Approx(double{wanted.distance}).margin(2e-5));
    const TileClosestPoint closest_point = closest_point_of(packets, nearest, point);
    CHECK(double{closest_point.distance} == Approx(double{wanted.distance}).margin(2e-5));
    CHECK(((packets.tile.valid >> closest_point.cell) & 1U) == 1);
  }
  CHECK(found > 400);
}

TEST_CASE("The nearest unit that faces a place has no nearer one that does") {
  constexpr float cosine = 0.998F;
  RandomTwister random(4);
  int found = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const TilePackets packets = random_cells(random);
    const Vector3 point = point_near(random, packets);
    const PrimitivePackets view{packets.cells, packets.clips, {}};
    const NearestPrimitive facing = nearest_facing(view, names(all_cells), floats(point), cosine);
    float least = std::numeric_limits<float>::infinity();
    for (const CellPacket& packet : packets.cells) {
      for (std::uint32_t lane = 0; lane < packet_width; ++lane) {
        const TileClosestPoint closest_point =
            closest_on_cell(packets.tile, packet, lane, point, 1.0F);
        const bool faces =
            std::abs(closest_point.below) > (cosine + 1e-4F) * closest_point.distance;
        if (std::isfinite(closest_point.distance) && faces)
          least = std::min(least, closest_point.distance);
      }
    }
    if (least < 0.0099F) CHECK(std::sqrt(facing.square) <= least + 2e-5F);
    if (!(facing.square < 0.9e-4F)) continue;
    ++found;
    const TileClosestPoint closest_point = closest_point_of(packets, facing, point);
    CHECK(std::abs(closest_point.below) >= (cosine - 1e-3F) * closest_point.distance);
  }
  CHECK(found > 200);
}

TEST_CASE("In a cube no unit is nearer than what reaches tell") {
  RandomTwister random(5);
  int told = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TilePackets packets = random_cells(random);
    std::vector<std::array<Vector3, 3>> corners;
    const std::vector<TrianglePacket> triangles{random_triangles(random, corners)};
    const PrimitivePackets view{packets.cells, packets.clips, triangles};
    const Vector3 middle = point_near(random, packets);
    const double half = random.between(1e-5, 1e-3);
    // A place that the surface is known to have.
    const Vector3 place = middle + vector_in(random, 0.004);
    SurfaceCube cube{floats(middle), static_cast<float>(half), {}};
    for (unsigned k = 0; k < 8; ++k) {
      const Vector3 corner = middle + half * Vector3((k & 1U) != 0 ? 1 : -1, (k & 2U) != 0 ? 1 : -1,
                                                     (k & 4U) != 0 ? 1 : -1);
      for (auto& known : cube.known) known[k] = static_cast<float>((corner - place).norm());
    }
    std::array<std::uint32_t, tile_packets + 1> numbers{0, 1, 2, 3, 4, 5, 6, 7, 8};
    std::array<PacketBounds, numbers.size()> lower_bounds;
    packet_bounds(view, numbers, cube, 1e-3F, lower_bounds.data());
    for (int sample = 0; sample < 20; ++sample) {
      const Vector3 point = middle + vector_in(random, half);
      Squares squares;
      static_cast<void>(packet_squares(view, names(numbers), floats(point), squares.values.data()));
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        for (std::size_t lane = 0; lane < packet_width; ++lane) {
          const double excess =
              std::sqrt(double{squares.values[i * packet_width + lane]}) - (point - place).norm();
          REQUIRE(excess >= double{lower_bounds[i].lower_bound} - 1e-6);
          const bool in_reach = ((lower_bounds[i].lanes >> lane) & 1U) != 0;
          REQUIRE((in_reach || excess >= 1e-3 - 1e-6));
          told += in_reach ? 0 : 1;
        }
      }
    }
  }
  CHECK(told > 1000);
}

TEST_CASE("The bounds of a group's triangles are their distances, and never more") {
  RandomTwister random(1);
  int close = 0, all = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<std::array<Vector3, 3>> corners;
    const std::vector<TrianglePacket> packets{random_triangles(random, corners)};
    const Vector3 place = vector_in(random, 0.012);
    const std::uint32_t number = 0;
    Squares squares;
    const std::uint32_t first = packet_squares({{}, {}, packets}, PackedNumbers(&number, 1, false),
                                               floats(place), squares.values.data());
    for (std::size_t lane = 0; lane < packet_width; ++lane) {
      const auto& [a, b, c] = corners[lane];
      const double exact = (place - closest_on_triangle(place, a, b, c)).norm();
      const double bound = std::sqrt(static_cast<double>(squares.values[lane]));
      CHECK(bound <= exact + 1e-7);
      CHECK(squares.values[lane] >= squares.values[first]);
      ++all;
      close += bound > 0.98 * exact ? 1 : 0;
    }
  }
  CHECK(close > all * 0.97);
}

TEST_CASE("The nearest unit of triangles is the closest point on the nearest of them") {
  RandomTwister random(6);
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<std::array<Vector3, 3>> corners;
    const std::vector<TrianglePacket> packets{random_triangles(random, corners)};
    const Vector3 place = vector_in(random, 0.012);
    const std::uint32_t number = 0;
    const NearestPrimitive found =
        nearest_primitive({{}, {}, packets}, PackedNumbers(&number, 1, false), floats(place));
    REQUIRE(found.is_found());
    Vector3 closest_point = Vector3::Constant(1);
    for (const auto& [a, b, c] : corners) {
      const Vector3 other = closest_on_triangle(place, a, b, c);
      if ((place - other).norm() < (place - closest_point).norm()) closest_point = other;
    }
    const Vector3 away(double{found.away[0]}, double{found.away[1]}, double{found.away[2]});
    CHECK(std::sqrt(double{found.square}) == Approx((place - closest_point).norm()).margin(1e-7));
    CHECK(away.norm() == Approx((place - closest_point).norm()).margin(1e-7));
    const auto& [a, b, c] = corners[found.which];
    CHECK((closest_on_triangle(place, a, b, c) - (place - away)).norm() < 2e-6);
  }
}

TEST_CASE("Every processor finds the same of groups, bit by bit, and lists the same") {
  RandomTwister random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const TilePackets tile = random_cells(random);
    std::vector<std::array<Vector3, 3>> corners;
    std::vector<TrianglePacket> triangles{random_triangles(random, corners)};
    // A copy, so that the smallest distance occurs twice.
    triangles.push_back(triangles.front());
    const PrimitivePackets packets{tile.cells, tile.clips, triangles};
    const std::array<std::uint32_t, 11> numbers{9, 0, 1, 2, 3, 8, 4, 5, 6, 7, 3};
    const std::array<float, 3> place = floats(point_near(random, tile));
    const auto farthest = static_cast<float>(random.between(0, 1e-4));
    SurfaceCube cube{place, 1e-3F, {}};
    for (auto& known : cube.known) known.fill(static_cast<float>(random.between(0, 0.01)));
    std::vector<std::vector<float>> found;
    std::vector<std::vector<std::uint32_t>> lists;
    std::array<float, numbers.size() * packet_width> bounds{};
    test::on_every_target([&] {
      Squares squares;
      std::array<float, numbers.size()> of_packets{};
      std::array<PacketBounds, numbers.size()> lower_bounds;
      std::vector<float>& all = found.emplace_back();
      std::vector<std::uint32_t>& list = lists.emplace_back();
      const auto keep = [&](const NearestPrimitive& unit) {
        list.push_back(unit.which);
        all.insert(all.end(), {unit.square, unit.x, unit.y});
        all.insert(all.end(), unit.away.begin(), unit.away.end());
      };
      keep(nearest_primitive(packets, names(numbers), place));
      keep(nearest_facing(packets, names(numbers), place, 0.99F));
      keep(nearest_of_packets(packets, names(numbers), place, of_packets.data()));
      all.insert(all.end(), of_packets.begin(), of_packets.end());
      packet_bounds(packets, numbers, cube, 1e-3F, lower_bounds.data());
      for (const PacketBounds& reach : lower_bounds) {
        all.push_back(reach.lower_bound);
        list.push_back(reach.lanes);
      }
      list.push_back(packet_squares(packets, names(numbers), place, squares.values.data()));
      std::array<std::uint32_t, (numbers.size() + 1) * packet_width> near{};
      const std::size_t count =
          near_lanes(squares.values.data(), bounds.size(), farthest, near.data());
      std::copy_n(squares.values.begin(), bounds.size(), bounds.begin());
      list.insert(list.end(), near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
      std::vector<std::uint32_t> wanted;
      for (std::uint32_t k = 0; k < bounds.size(); ++k) {
        if (bounds[k] <= farthest) wanted.push_back(k);
      }
      CHECK(std::equal(wanted.begin(), wanted.end(), near.begin()));
      CHECK(wanted.size() == count);
    });
    REQUIRE(!found.empty());
    for (std::size_t k = 0; k < found.size(); ++k) {
      CHECK(found[k] == found.front());
      CHECK(lists[k] == lists.front());
    }
  }
}

TEST_CASE("Lanes without a unit, and numbers of no group, are out of all reach") {
  std::vector<CellPacket> cells(1);
  cells.front().spacing = 1e-3F;
  cells.front().depth.fill(1e15F);
  const std::vector<TrianglePacket> triangles(1);
  const std::array<std::uint32_t, 3> numbers{0, 1, 7};
  const PrimitivePackets packets{cells, {}, triangles};
  Squares squares;
  static_cast<void>(packet_squares(packets, names(numbers), {0.01F, 0, 0}, squares.values.data()));
  for (std::size_t k = 0; k < numbers.size() * packet_width; ++k) CHECK(squares.values[k] > 1e20F);
  CHECK_FALSE(nearest_primitive(packets, names(numbers), {0.01F, 0, 0}).is_found());
}

}  // namespace
}  // namespace spm::primitive_packets_test
