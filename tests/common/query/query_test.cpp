// SPDX-License-Identifier: Apache-2.0
#include "common/query/query.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "common/base/octahedral.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::query_test {
namespace {

using test::BoxByHand;

const Vector3 size(0.04, 0.04, 0.04);
constexpr std::uint32_t record = static_cast<std::uint32_t>(CellKind::record) << 30U;

TEST_CASE("Below a face of a box the query gives its depth, normal, plane and layer") {
  const BoxByHand box(size);
  const Answer answer = query_point(box.view, {0.003, 0.019, -0.002});
  CHECK(answer.status == Status::exact);
  CHECK(answer.distance == Approx(-0.001));
  CHECK((answer.normal - Vector3::UnitY()).norm() < 1e-6);
  CHECK(answer.plane == 2);
  CHECK(answer.layer == 0);
  CHECK(answer.source == Source::map);
}

TEST_CASE("Exit layers answer with the solid on their plane's side") {
  BoxByHand box(size);
  // Seen from +y, the exit layer is the face at -y.
  box.records = {list_header(1, 0), pack_candidate({2, 1})};
  box.refresh();
  const Answer answer = query_point(box.view, {0.003, -0.019, -0.002});
  CHECK(answer.distance == Approx(-0.001));
  CHECK((answer.normal + Vector3::UnitY()).norm() < 1e-6);
  CHECK(answer.layer == 1);
}

TEST_CASE("Outside within the margin the distance is positive, beyond it the answer is far") {
  const BoxByHand box(size);
  CHECK(query_point(box.view, {0, 0, 0.0203}).distance == Approx(0.0003));
  const Answer far = query_point(box.view, {0, 0, 0.021});
  CHECK(far.status == Status::far);
  CHECK(std::isnan(far.distance));
  CHECK(far.normal.isZero());
}

TEST_CASE("Deeper than the band the answer is its bound and a normal") {
  const BoxByHand box(size);
  const Answer answer = query_point(box.view, {0, 0.015, 0});
  CHECK(answer.status == Status::deep);
  CHECK(answer.distance == -0.002);
  CHECK((answer.normal - Vector3::UnitY()).norm() < 1e-6);
}

TEST_CASE("A deep cell answers with its own normal, a pruned one says so") {
  BoxByHand box(size);
  const Vector3 normal = Vector3(1, -2, 3).normalized();
  box.index = {static_cast<std::uint32_t>(CellKind::deep) << 30U | pack_octahedral(normal)};
  box.refresh();
  const Answer deep = query_point(box.view, {0, 0, 0});
  CHECK(deep.status == Status::deep);
  CHECK(deep.distance == -0.002);
  CHECK((deep.normal - normal).norm() < 2e-4);
  box.index = {static_cast<std::uint32_t>(CellKind::pruned) << 30U};
  box.refresh();
  CHECK(query_point(box.view, {0, 0, 0}).status == Status::pruned);
}

TEST_CASE("A split cell is answered by the octant that holds the point") {
  BoxByHand box(size);
  box.index = {record | split_bit};
  box.records.assign(8, record | 8);
  // The face at +z only.
  box.records.insert(box.records.end(), {list_header(1, 0), 4});
  box.records[0] = static_cast<std::uint32_t>(CellKind::pruned) << 30U;
  box.refresh();
  CHECK(query_point(box.view, {-0.01, -0.01, -0.01}).status == Status::pruned);
  CHECK(query_point(box.view, {0.01, 0.01, 0.019}).distance == Approx(-0.001));
}

TEST_CASE("Triangles answer exactly, and the side at a convex edge is outside") {
  BoxByHand box(size);
  // Two faces that meet at the edge x = y = 0.02, solid below both.
  box.triangles = {0.02F, 0.02F, 1,  0.02F, 0.02F, -1, -1,    0.02F, 0,
                   0.02F, 0.02F, -1, 0.02F, 0.02F, 1,  0.02F, -1,    0};
  box.records = {list_header(0, 2), 0, 2};
  box.refresh();
  const Answer inside = query_point(box.view, {0.0, 0.0195, 0});
  CHECK(inside.distance == Approx(-0.0005));
  CHECK(inside.source == Source::triangles);
  CHECK(inside.plane == -1);
  const Answer outside = query_point(box.view, {0.02018, 0.02024, 0});
  CHECK(outside.distance == Approx(0.0003).margin(1e-8));
  CHECK((outside.normal - Vector3(0.6, 0.8, 0)).norm() < 1e-3);
}

TEST_CASE("A sheet in a full asset is felt from both sides at its half-thickness") {
  BoxByHand box(size, {0.02, 0.02});
  box.triangles = {
      -0.001F, 0,      0.01F, 0.001F, 0,      0.01F, 0, 0.001F, 0.01F,  // of a solid, faces +z
      -0.02F,  -0.02F, 0,     0.02F,  -0.02F, 0,     0, 0.02F,  0};     // of a sheet
  box.records = {list_header(0, 2), 0, 3};
  box.refresh();
  box.view.sheet_thickness = 0.0003;
  CHECK(query_point(box.view, {0, 0, 0.0095}).distance == Approx(-0.0005).margin(1e-7));
  box.records = {list_header(0, 1), 3};
  box.refresh();
  box.view.sheet_thickness = 0.0003;
  for (const double height : {-0.001, 0.0001}) {
    const Answer answer = query_point(box.view, {0, 0, height});
    CHECK(answer.distance == Approx(std::abs(height) - 0.0003).margin(1e-7));
    CHECK(answer.normal.z() == Approx(height > 0 ? 1 : -1));
  }
}

TEST_CASE("Points that are not finite are far") {
  const BoxByHand box(size);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector3& point : {Vector3(nan, 0, 0), Vector3(0, infinity, 0),
                               Vector3(0, 0, -infinity), Vector3(1e308, 1e308, 1e308)}) {
    CHECK(query_point(box.view, point).status == Status::far);
  }
}

TEST_CASE("Splits lead as deep as they may, and no deeper") {
  BoxByHand box(size);
  const std::vector<std::uint32_t> list = box.records;
  for (int levels = 1; levels <= split_levels + 1; ++levels) {
    // The last octant of each split is split again; in the last split it is the list.
    box.index = {record | split_bit};
    box.records.clear();
    for (int level = 1; level <= levels; ++level) {
      const auto next = static_cast<std::uint32_t>(8 * level);
      box.records.insert(box.records.end(), 7, static_cast<std::uint32_t>(CellKind::pruned) << 30U);
      box.records.push_back(record | next | (level < levels ? split_bit : 0));
    }
    box.records.insert(box.records.end(), list.begin(), list.end());
    box.refresh();
    const Answer answer = query_point(box.view, {0.0199, 0.0199, 0.0199});
    CHECK(answer.status == (levels <= split_levels ? Status::exact : Status::far));
    CHECK(query_point(box.view, {-0.019, 0.0199, 0.0195}).status == Status::pruned);
  }
}

TEST_CASE("Words of a grid that were damaged under the map never lead outside it") {
  std::mt19937_64 bits(12);
  const auto random = [&bits](std::uint32_t bound) {
    return static_cast<std::uint32_t>(bits() % bound);
  };
  for (int trial = 0; trial < 3000; ++trial) {
    BoxByHand box(size);
    box.triangles.assign(18, 0.01F);
    for (std::uint32_t& word : box.records) {
      word = static_cast<std::uint32_t>(bits());
      if (trial % 3 == 0) word = record | (word & split_bit) | random(9);
    }
    if (trial % 3 == 1) box.records[0] = list_header(random(8), random(8));
    box.index[0] = record | random(9) | (random(2) == 0 ? split_bit : 0);
    if (random(4) == 0) box.index[0] = record | static_cast<std::uint32_t>(bits());
    box.refresh();
    const Answer answer = query_point(box.view, {0.001, 0.019, 0.002});
    const bool answered = answer.status == Status::exact || answer.status == Status::deep;
    CHECK(answered == std::isfinite(answer.distance));
  }
}

}  // namespace
}  // namespace spm::query_test
