// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/rendering_cost.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <string>

#include "tests/stability/objects/prepared_object.hpp"

namespace spm::stability::rendering_cost_test {
namespace {

/// A box; the walked slide passes under each of its edges.
StabilityCase small_box() {
  StabilityCase object;
  object.name = "small-box";
  object.shape = test::box(Vector3(0.02, 0.016, 0.012));
  object.tolerance = 50e-6;
  object.max_depth = 2e-3;
  object.encoder_step = 0;
  return object;
}

CostPlan short_slide() {
  CostPlan plan;
  plan.ticks = 1500;
  return plan;
}

TEST_CASE("A held slide begins anew behind each edge, from a free place above it") {
  const StabilityCase object = small_box();
  const HeldSlide slide = held_slide(object, short_slide());
  const baker::ExactSurface& truth = prepared_object(object).model().truth;
  const auto& ticks = slide.path.ticks;
  REQUIRE(slide.free_places.size() == ticks.size());
  int begun = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (!ticks[i].fresh) {
      // Edges are of 90 degrees.
      REQUIRE(i > 0);
      REQUIRE(ticks[i].outward.dot(ticks[i - 1].outward) > 0.8);
      continue;
    }
    ++begun;
    const Vector3& place = slide.free_places[i];
    CHECK_FALSE(truth.inside(place));
    CHECK((place - slide.path.points[i]).norm() ==
          Approx(2 * object.tolerance - ticks[i].distance).epsilon(1e-6));
  }
  CHECK(begun > 3);
}

TEST_CASE("On a box's slide every method but the paper's is right within a few per cent") {
  const std::vector<Contender> contenders{
      {"exact-penalty", {}}, {"mesh-proxy", {}}, {"spm", {}}, {"proxy", {}}, {"proxy", "damping"}};
  std::map<std::string, CostRow> rows;
  for (const CostRow& row : measure_costs(contenders, small_box(), short_slide())) {
    rows[row.method] = row;
  }
  REQUIRE(rows.size() == contenders.size());
  CHECK(rows["exact-penalty"].relative_error < 1e-9);
  for (const char* method : {"mesh-proxy", "spm", "proxy"}) {
    CAPTURE(method);
    CHECK(rows[method].relative_error > 0);
    CHECK(rows[method].relative_error < 0.05);
    CHECK(rows[method].median_error < 0.05);
    CHECK(rows[method].lost_share == 0);
  }
  // Braking stabilizers are meant to differ while the tool moves.
  CHECK(rows["proxy+damping"].relative_error > rows["proxy"].relative_error);
}

}  // namespace
}  // namespace spm::stability::rendering_cost_test
