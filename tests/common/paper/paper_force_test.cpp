// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_force.hpp"

#include <catch2/catch.hpp>
#include <random>

#include "tests/support/asset_by_hand.hpp"
#include "tests/support/every_target.hpp"

namespace spm::paper_force_test {
namespace {

using test::BoxByHand;

const Vector3 size(0.04, 0.05, 0.06);

TEST_CASE("The closest support plane is the one with the least S_SP among all") {
  const BoxByHand box(size);
  std::mt19937_64 bits(5);
  for (int i = 0; i < 500; ++i) {
    const auto unit = [&] { return static_cast<double>(bits() >> 11U) * 0x1p-53 - 0.5; };
    const Vector3 point(0.08 * unit(), 0.08 * unit(), 0.08 * unit());
    const std::size_t found = closest_support_plane(box.view, point);
    for (const SupportPlane& plane : box.planes) {
      CHECK(support_plane_depth(box.planes[found], point) <=
            support_plane_depth(plane, point) + 1e-15);
    }
  }
}

TEST_CASE("The search over planes finds the same plane whatever their number") {
  std::mt19937_64 bits(6);
  for (const std::size_t count : {4U, 15U, 16U, 17U, 33U, 1000U, 1003U}) {
    std::vector<double> nx, ny, nz, offset;
    for (std::size_t i = 0; i < count; ++i) {
      const auto unit = [&] { return static_cast<double>(bits() >> 11U) * 0x1p-53 - 0.5; };
      const Vector3 normal = Vector3(unit(), unit(), unit()).normalized();
      nx.push_back(normal.x());
      ny.push_back(normal.y());
      nz.push_back(normal.z());
      offset.push_back(0.05 + 0.01 * unit());
    }
    AssetView view;
    view.plane_nx = nx;
    view.plane_ny = ny;
    view.plane_nz = nz;
    view.plane_offset = offset;
    const Vector3 point(0.01, -0.02, 0.005);
    std::size_t best = 0;
    for (std::size_t i = 1; i < count; ++i) {
      const auto depth = [&](std::size_t k) {
        return offset[k] - (nx[k] * point.x() + ny[k] * point.y() + nz[k] * point.z());
      };
      if (depth(i) < depth(best)) best = i;
    }
    test::on_every_target([&] { CHECK(closest_support_plane(view, point) == best); });
  }
}

TEST_CASE("On a box the paper's force is k times the depth along the face's normal (eq. 9)") {
  const BoxByHand box(size);
  const Vector3 point(0.005, -0.0235, 0.01);
  const PaperContact found = paper_contact(box.view, point, PaperRule::closest_plane);
  REQUIRE(found.contact);
  CHECK(found.plane_depth == Approx(0.0015));
  CHECK(found.depth == Approx(0.0015));
  const Vector3 force = paper_force(found, 1000);
  CHECK((force - Vector3(0, -1.5, 0)).norm() < 1e-6);
  CHECK(force.norm() ==
        Approx(paper_force_magnitude(1000, found.plane_depth, found.surface_distance)));
}

TEST_CASE("Outside there is no contact and no force, although eq. 3 is not zero there") {
  const BoxByHand box(size);
  const PaperContact found = paper_contact(box.view, {0, 0, 0.031}, PaperRule::closest_plane);
  CHECK_FALSE(found.contact);
  CHECK(paper_force(found, 1000).isZero());
  CHECK(paper_force_magnitude(1000, found.plane_depth, found.surface_distance) > 0);
}

TEST_CASE("A nearest plane that looks at a deeper surface underestimates the depth, visibly") {
  BoxByHand box(size);
  // The map of +z sees a floor 10 mm down: a box with a wide pit.
  for (std::size_t i = 0; i < std::size_t{17} * 17; ++i) box.by_hand[4].samples[i] = 0.01F;
  box.refresh();
  const Vector3 wall_side(0.0195, 0, 0.0299);
  const PaperContact found = paper_contact(box.view, wall_side, PaperRule::closest_plane);
  CHECK(found.plane == 4);
  CHECK_FALSE(found.contact);
}

TEST_CASE("The reading closest-surface takes the plane whose surface is nearest") {
  BoxByHand box(size);
  for (std::size_t i = 0; i < std::size_t{17} * 17; ++i) box.by_hand[4].samples[i] = 0.01F;
  box.refresh();
  const PaperContact found =
      paper_contact(box.view, {0.0195, 0, 0.0295}, PaperRule::closest_surface);
  CHECK(found.contact);
  CHECK(found.plane == 0);
  CHECK(found.depth == Approx(0.0005));
}

TEST_CASE("The reading all-planes is an AND: one plane that sees nothing there forbids contact") {
  BoxByHand box(size);
  const Vector3 point(0.005, 0.002, 0.028);
  const PaperContact before = paper_contact(box.view, point, PaperRule::all_planes);
  CHECK(before.contact);
  CHECK(before.depth == Approx(0.002));
  for (std::size_t i = 0; i < std::size_t{17} * 17; ++i) box.by_hand[1].samples[i] = 0.039F;
  box.refresh();
  CHECK_FALSE(paper_contact(box.view, point, PaperRule::all_planes).contact);
}

TEST_CASE("By the partition the closest of the planes that a cell lists is taken, else of all") {
  BoxByHand box(size);
  const Vector3 point(0.005, 0.002, 0.028);  // nearest to the plane of +z
  REQUIRE(paper_contact(box.view, point, PaperRule::closest_plane).plane == 4);
  CHECK(paper_contact(box.view, point, PaperRule::partition).plane == 4);
  box.records = {list_header(2, 0), pack_candidate({0, 0}), pack_candidate({1, 0})};
  box.refresh();
  const PaperContact found = paper_contact(box.view, point, PaperRule::partition);
  CHECK(found.plane == 0);
  CHECK(found.contact);
  CHECK(found.depth == Approx(size.x() / 2 - 0.005));
  // A cell that lists nothing, and none at all.
  box.records = {list_header(0, 0)};
  box.refresh();
  CHECK(paper_contact(box.view, point, PaperRule::partition).plane == 4);
  box.index = {static_cast<std::uint32_t>(CellKind::far) << 30U};
  box.refresh();
  CHECK(paper_contact(box.view, point, PaperRule::partition).plane == 4);
}

TEST_CASE("Beside a silhouette the nearest sample decides, not a blend with a miss") {
  BoxByHand box(size);
  box.by_hand[4].samples[8 * 17 + 9] = no_hit;
  box.refresh();
  const DistanceMap& map = box.maps[4];
  const auto at = [&](double column) {
    const Vector3 point =
        reconstructed_surface(box.planes[4], column * map.spacing, 8 * map.spacing, 0.0001);
    return paper_contact(box.view, point, PaperRule::closest_plane);
  };
  CHECK(at(8.4).contact);
  CHECK_FALSE(at(8.6).contact);
}

}  // namespace
}  // namespace spm::paper_force_test
