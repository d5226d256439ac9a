// SPDX-License-Identifier: GPL-3.0-or-later
// The octree of a surface answers within the tolerance everywhere in the band.
#include <catch2/catch.hpp>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "baker/charts/chart_field.hpp"
#include "baker/charts/chart_heights.hpp"
#include "baker/charts/plane_charts.hpp"
#include "baker/field/chart_fit.hpp"
#include "baker/field/cube_candidates.hpp"
#include "baker/field/map_proof.hpp"
#include "baker/field/octree_build.hpp"
#include "baker/planes/hull.hpp"
#include "baker/planes/planes.hpp"
#include "baker/verify/answer_shares.hpp"
#include "common/base/random.hpp"
#include "common/field/octree_leaves.hpp"
#include "common/query/query.hpp"
#include "common/query/query_cursor.hpp"
#include "formats/asset/chart_words.hpp"
#include "formats/asset/octree_check.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::octree_test {
namespace {

constexpr double tolerance = 5e-5;

/// A shape with all that its octree is made from.
struct Built {
  OuterSurface surface;
  Caster caster;
  LatticeSurface lattice;
  Caster rounded;
  std::vector<SupportPlane> planes;
  PlaneCharts charts;
  ChartHeights heights;
  OctreeRules rules;
  BuiltOctree built;
  std::vector<HeightChart> seen_charts;
  AssetView view;

  explicit Built(const test::Shape& shape, std::optional<double> bytes = {})
      : surface(test::surface_of(shape)),
        caster(surface),
        lattice(round_to_lattice(surface, caster, tolerance)),
        rounded(lattice.surface),
        planes(vertex_based_planes(convex_hull(shape.vertices), 20)),
        charts(lattice.surface, planes, 4e-3),
        heights(
            rounded, lattice.surface, planes, charts,
            {.coarsest = 1e-3, .curved = 0, .levels = 2, .offset = -1.2e-3, .offset_levels = 2}) {
    rules.band = {2e-3, 0.5e-3};
    rules.tolerance = tolerance;
    rules.smallest_edge = 5e-4;
    rules.levels = 3;
    rules.bytes = bytes;
    rules.direction = 6 * std::numbers::pi / 180;
    built = build_octree(lattice, rounded, heights, nullptr, rules, {});
    built.data.add_to(view);
    for (const ChartData& chart : built.atlas.charts) {
      REQUIRE(
          chart_problem(chart, built.planes.size(), built.atlas.width, built.atlas.heights.size())
              .empty());
      seen_charts.push_back(chart_over(chart, built.planes[chart.plane], built.atlas,
                                       std::span<const float>(built.atlas.heights)));
    }
    view.planes = built.planes;
    view.charts = seen_charts;
    view.atlas = std::span<const float>(built.atlas.heights);
    view.band = rules.band;
    view.tolerance = tolerance;
  }

  /// A place around the surface.
  [[nodiscard]] Vector3 place(std::uint64_t i) const {
    const auto t = static_cast<std::uint32_t>(random_unit(5, 5 * i) *
                                              static_cast<double>(surface.triangles.size()));
    const double a = random_unit(5, 5 * i + 1), b = random_unit(5, 5 * i + 2) * (1 - a);
    const double depth = 3e-3 * random_unit(5, 5 * i + 3) - 2.2e-3;
    const Vector3& from = caster.corner(t, 0);
    return from + a * (caster.corner(t, 1) - from) + b * (caster.corner(t, 2) - from) +
           depth * caster.normal(t);
  }
};

/// The same with corners in disorder, so that facets are rough.
test::Shape rough(test::Shape shape, double by) {
  for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
    shape.vertices[i] *= 1 + by * (random_unit(8, i) - 0.5);
  }
  return shape;
}

/// A chain of two balls as thick as the band is deep.
test::Shape thin_limbs() {
  return test::merged(test::sphere(1.5e-3, 3), test::moved(test::sphere(1.9e-3, 3), {6e-3, 0, 0}));
}

/// Answers are within the tolerance at places all around the surface.
void require_right(const Built& made, std::uint64_t places) {
  CHECK(octree_problem(made.view).empty());
  for (std::uint64_t i = 0; i < places; ++i) {
    const Vector3 point = made.place(i);
    const double truth = made.caster.closest(point).distance;
    const Answer answer = query_point(made.view, point);
    INFO(point.transpose() << " m, truth " << truth << " m, told " << answer.distance << " m");
    if (truth > made.rules.band.margin) {
      REQUIRE(
          (answer.status == Status::far || answer.distance >= made.rules.band.margin - tolerance));
    } else if (truth < -made.rules.band.max_depth) {
      REQUIRE(answer.distance <= -made.rules.band.max_depth + tolerance);
    } else if (answer.status == Status::far) {
      REQUIRE(truth >= made.rules.band.margin - tolerance);
    } else {
      REQUIRE(std::abs(answer.distance - truth) <= tolerance);
    }
  }
}

}  // namespace

TEST_CASE("Everywhere in the band the octree answers, on the right side, within the tolerance") {
  for (const test::Shape& shape :
       {test::sphere(0.01, 3), rough(test::sphere(0.01, 4), 2e-3), test::box({0.02, 0.01, 0.004}),
        test::torus(0.01, 0.003, 40, 20), test::plate({0.02, 0.02, 2e-4}), test::wedge(0.2, 0.02),
        thin_limbs()}) {
    require_right(Built(shape), 20000);
  }
}

TEST_CASE("In front of a box's edges two maps answer with the distance from the edge") {
  const Built made(test::box({0.02, 0.01, 0.004}));
  std::size_t found = 0;
  visit_leaves(made.view.octree, [&](const Leaf& leaf) {
    const std::uint32_t* words = words_at(made.view.octree, leaf);
    if (leaf.kind != OctreeKind::map || !NamedMaps(words[0]).pair.edge) return;
    for (const double x : {-0.9, -0.3, 0.3, 0.9}) {
      const Vector3 place = leaf.middle + leaf.half * Vector3(x, 0.7 * x, -0.4 * x);
      const ClosestPoint truth = made.caster.closest(place);
      if (truth.distance < 1e-4 || truth.distance > 4e-4) continue;
      const Answer answer = query_point(made.view, place);
      const Vector3 away = truth.direction;
      CHECK(answer.distance == Approx(truth.distance).margin(1e-6));
      CHECK((answer.normal - away).norm() < 1e-3);
      found += away.cwiseAbs().maxCoeff() < 0.99 ? 1 : 0;
    }
  });
  CHECK(found > 40);
}

TEST_CASE("With fewer bytes more lists answer, as right, and with more bytes fewer") {
  for (const test::Shape& shape :
       {test::box({0.02, 0.01, 0.004}), test::torus(0.01, 0.003, 16, 10), test::wedge(0.2, 0.02)}) {
    const Built usual(shape);
    double least = shares_of_places(usual.view).band.triangles;
    for (const double share : {4.0, 1.0, 0.8}) {
      const double bytes = share * static_cast<double>(usual.built.counts.bytes);
      const Built made(shape, bytes);
      CHECK(static_cast<double>(made.built.counts.bytes) <= bytes);
      const double by_lists = shares_of_places(made.view).band.triangles;
      CHECK((share > 1 || by_lists >= least));
      least = by_lists;
      require_right(made, 5000);
    }
    try {
      const Built none(shape, 100);
      FAIL("an octree of 100 bytes");
    } catch (const BakeError& error) {
      CHECK(error.code() == ExitCode::tolerance_not_met);
      CHECK(std::string(error.what()).find("--max-bytes") != std::string::npos);
    }
  }
}

TEST_CASE("Roots are parted where bytes times time are least so, but not where bytes are given") {
  const test::Shape ring = rough(test::torus(0.02, 0.002, 200, 40), 1e-2);
  const Built free(ring), given(ring, 1e8);
  const double first = std::ldexp(free.rules.smallest_edge, free.rules.levels);
  CHECK(free.built.data.edge == first / 2);
  CHECK(given.built.data.edge == first);
}

TEST_CASE("Where the answer is far, the surface is at least as far as the clearance says") {
  const Built made(test::torus(0.01, 0.003, 40, 20));
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Vector3 point =
        0.06 * Vector3(random_unit(2, 3 * i) - 0.5, random_unit(2, 3 * i + 1) - 0.5,
                       random_unit(2, 3 * i + 2) - 0.5);
    if (query_point(made.view, point).status != Status::far) continue;
    const double truth = made.caster.closest(point).distance;
    CHECK(clearance(made.view, point) <= truth + tolerance);
  }
  CHECK(clearance(made.view, {0.2, 0, 0}) > 0.15);
}

TEST_CASE("Outside an object's box the clearance is nearly the distance") {
  // A torus leaves much of its box free.
  for (const auto& [shape, share] : {std::pair{test::torus(0.01, 0.003, 40, 20), 0.7},
                                     std::pair{test::box({0.02, 0.01, 0.004}), 0.99}}) {
    Built made(shape);
    made.view.box_low = made.view.box_high = shape.vertices.front();
    for (const Vector3& corner : shape.vertices) {
      made.view.box_low = made.view.box_low.cwiseMin(corner);
      made.view.box_high = made.view.box_high.cwiseMax(corner);
    }
    const Vector3 size = made.view.box_high - made.view.box_low;
    QueryCursor cursor;
    cursor.begin(&made.view);
    double told = 0, far = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      Vector3 point = made.view.box_low;
      for (unsigned axis = 0; axis < 3; ++axis) {
        point[axis] += (1.6 * random_unit(6, 3 * i + axis) - 0.3) * size[axis];
      }
      const Vector3 inside = point.cwiseMax(made.view.box_low).cwiseMin(made.view.box_high);
      if (inside == point) continue;
      const Answer answer = query_point(made.view, point);
      REQUIRE(cursor.query(point).status == answer.status);
      if (answer.status != Status::far) continue;
      const double truth = made.caster.closest(point).distance, least = clearance(made.view, point);
      REQUIRE(least <= truth + tolerance);
      CHECK(cursor.clearance(point) == least);
      // Where less is of use, no more than that needs to be told.
      CHECK(cursor.clearance(point, 1e-3) <= least);
      CHECK(cursor.clearance(point, 1e-3) >= std::min(0.5 * least, 0.999e-3));
      told += least;
      far += truth;
    }
    REQUIRE(far > 0);
    CHECK(told > share * far);
  }
}

TEST_CASE("Just beyond the margin a clearance is no more than the distance, and grows with it") {
  for (const test::Shape& shape : {test::torus(0.01, 0.003, 40, 20), test::box({0.02, 0.01, 0.004}),
                                   rough(test::torus(0.02, 0.002, 200, 40), 2e-2)}) {
    const Built made(shape);
    const double margin = made.view.band.margin;
    CHECK(made.view.octree.beyond_share == beyond_share);
    QueryCursor cursor;
    cursor.begin(&made.view);
    double told = 0, beyond = 0;
    for (std::uint64_t i = 0; i < 200000; ++i) {
      const Vector3 point = made.place(i);
      const double truth = made.caster.closest(point).distance;
      if (cursor.query(point).status != Status::far || truth > 2 * margin) continue;
      const double least = clearance(made.view, point);
      CHECK(least <= truth + tolerance);
      CHECK(cursor.clearance(point) == least);
      told += std::max(0.0, least - margin);
      beyond += truth - margin;
    }
    REQUIRE(beyond > 0);
    CHECK(told > 0.3 * beyond);
  }
}

TEST_CASE("Many points at once get the answers that each gets alone") {
  const Built made(test::box({0.02, 0.01, 0.004}));
  std::vector<Vector3> points;
  for (std::uint64_t i = 0; i < 1000; ++i) points.push_back(made.place(i));
  std::vector<Answer> answers(points.size());
  query_points(made.view, points, answers);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Answer alone = query_point(made.view, points[i]);
    CHECK(answers[i].status == alone.status);
    CHECK((answers[i].distance == alone.distance || alone.status == Status::far));
    CHECK(answers[i].normal == alone.normal);
  }
}

namespace {

/// The samples and candidates of a cube.
struct Sampled {
  CandidateTree tree;
  std::vector<CubeSample> samples;

  Sampled(const Built& made, const Cube& cube)
      : tree(candidate_tree(made.lattice, cube, candidates_of(made.lattice, near(made, cube), cube),
                            {})),
        samples(sample_cube(made.lattice, tree.candidates, cube, tree.inside)) {}

  static std::vector<std::uint32_t> near(const Built& made, const Cube& cube) {
    const double distance = std::abs(made.rounded.closest(cube.middle).distance);
    std::vector<std::uint32_t> triangles;
    made.rounded.within(cube.middle, distance + 2 * cube.radius(), triangles);
    return triangles;
  }
};

/// What one map tells, or two, and so much more, m.
class ShiftedMaps {
 public:
  ShiftedMaps(const Built& made, const FittedCharts& found) : made_(made), pair_(found.pair) {
    for (const ChartAtLevel& at : found.charts) fields_.emplace_back(made.heights, at, 0);
  }

  [[nodiscard]] bool proves(CandidateTree& tree, double by, double within = tolerance) {
    std::vector<const BoundedField*> bounded;
    for (Shifted& field : fields_) {
      field.by = by;
      bounded.push_back(&field);
    }
    return prove_fields(made_.lattice, tree, pair_, bounded, made_.rules.band, within);
  }
  /// How far the maps are above the samples of the band, or below them where `sign` is -1.
  [[nodiscard]] std::optional<double> most_off(const Cube& cube,
                                               const std::vector<CubeSample>& samples,
                                               double sign) const {
    std::optional<double> most;
    for (const CubeSample& sample : samples) {
      if (!in_band(sample, made_.rules.band, 0)) continue;
      const double off = sign * (at(cube.middle + cube.half * sample.place) - sample.distance);
      most = std::max(most.value_or(off), off);
    }
    return most;
  }

 private:
  struct Shifted : BoundedField {
    ChartField field;
    double by;
    Shifted(const ChartHeights& heights, const ChartAtLevel& at, double shift)
        : field(heights, at), by(shift) {}
    [[nodiscard]] FieldBound about(const Vector3& middle, double half) const override {
      FieldBound bound = field.about(middle, half);
      bound.near.value += by;
      return bound;
    }
  };
  const Built& made_;
  MapPair pair_;
  std::vector<Shifted> fields_;

  [[nodiscard]] double at(const Vector3& place) const {
    Vector3 normal;
    const double first = fields_.front().field.at(place, normal);
    const double second = fields_.back().field.at(place, normal);
    return pair_.larger ? std::max(first, second) : std::min(first, second);
  }
};

struct ProofCounts {
  std::size_t proven = 0, spoilt = 0, spoilt_and_proven = 0, of_offset = 0;
};

/// Proves the maps of leaves, and again spoilt so that one of the samples in the band is off by a
/// hundredth more than is allowed.
template <class Find>
ProofCounts prove_and_spoil(const Built& made, const Find& find) {
  const ChartRules rules{&made.heights, made.rules.band, 0.9 * tolerance, made.rules.direction};
  ProofCounts counts;
  visit_leaves(made.view.octree, [&](const Leaf& leaf) {
    if (!has_answers(leaf.kind) || counts.spoilt >= 300) return;
    const Cube cube{leaf.middle, leaf.half};
    Sampled sampled(made, cube);
    static_cast<void>(find(sampled.samples, cube, rules, [&](const FittedCharts& found) {
      // Where the edge of two counts, a shift is not one of the distance.
      if (found.pair.edge) return false;
      ShiftedMaps maps(made, found);
      if (!maps.proves(sampled.tree, 0)) return false;
      ++counts.proven;
      counts.of_offset += found.charts.front().offset ? 1U : 0U;
      for (const double sign : {-1.0, 1.0}) {
        const std::optional<double> most = maps.most_off(cube, sampled.samples, sign);
        if (!most) continue;
        ++counts.spoilt;
        counts.spoilt_and_proven +=
            maps.proves(sampled.tree, sign * (1.01 * tolerance - *most)) ? 1U : 0U;
      }
      return true;
    }));
  });
  return counts;
}

}  // namespace

TEST_CASE("A map that is off by more than the tolerance somewhere is never proven") {
  const Built made(rough(test::sphere(0.01, 4), 1e-3));
  const ProofCounts counts = prove_and_spoil(made, find_one_chart);
  CHECK(counts.proven > 100);
  CHECK(counts.of_offset > 10);
  CHECK(counts.spoilt > 100);
  CHECK(counts.spoilt_and_proven == 0);
}

TEST_CASE("Two maps that together are off somewhere are never proven") {
  // A lens whose medial axis lies in the band.
  test::Shape lens = test::sphere(0.02, 5);
  for (Vector3& vertex : lens.vertices) vertex[2] *= 0.08;
  const ProofCounts counts = prove_and_spoil(Built(lens), find_two_charts);
  CHECK(counts.proven > 50);
  CHECK(counts.spoilt > 50);
  CHECK(counts.spoilt_and_proven == 0);
}

TEST_CASE(
    "Across a wall without a clear normal a map is proven in cubes as wide as the tolerance") {
  // Both sides of a wall of 1 um pass the cube, so that no cone holds their normals.
  const Built made(test::box({0.02, 0.02, 1e-6}));
  const Cube cube{{0.001, 0.002, 1e-6}, 0.4 * tolerance};
  Sampled sampled(made, cube);
  const ChartRules rules{&made.heights, made.rules.band, 0.9 * tolerance, std::numbers::pi};
  const auto proves = [&](double share) {
    return find_one_chart(
               sampled.samples, cube, rules,
               [&](const FittedCharts& found) {
                 return ShiftedMaps(made, found).proves(sampled.tree, 0, share * tolerance);
               })
        .has_value();
  };
  CHECK(proves(1));
  CHECK_FALSE(proves(0.1));
}

TEST_CASE("Lists take the place of maps only where bytes are given") {
  const test::Shape shape = test::box({0.02, 0.02, 0.02});
  const Built free(shape);
  const double given = 0.8 * static_cast<double>(free.built.counts.bytes);
  const Built few(shape, given);
  CHECK(static_cast<double>(few.built.counts.bytes) <= given);
  const AnswerShares most = shares_of_places(free.view).band,
                     some = shares_of_places(few.view).band;
  CHECK(most.one_map + most.two_maps > some.one_map + some.two_maps);
}

TEST_CASE("Distance maps answer with the plane that they lie on and a unit normal") {
  const Built made(test::sphere(0.01, 5));
  const AnswerShares shares = shares_of_places(made.view).band;
  CHECK(shares.one_map + shares.two_maps > 0.1);
  std::size_t by_maps = 0;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const Answer answer = query_point(made.view, made.place(i));
    if (answer.source != Source::map) continue;
    ++by_maps;
    REQUIRE(answer.plane >= 0);
    CHECK(answer.normal.norm() == Approx(1).margin(1e-9));
  }
  CHECK(by_maps > 500);
}

TEST_CASE("Along a crease two distance maps answer, the larger of them outside") {
  const Built made(test::box({0.02, 0.02, 0.02}));
  CHECK(made.built.counts.map_pairs + made.built.counts.lists > 0);
  require_right(made, 20000);
}

TEST_CASE("The words are the same every time") {
  const test::Shape shape = rough(test::sphere(0.01, 3), 2e-3);
  const Built one(shape), again(shape);
  CHECK(one.built.data.words == again.built.data.words);
  CHECK(one.built.data.lists == again.built.data.lists);
  CHECK(one.built.data.corners == again.built.data.corners);
  CHECK(one.built.data.triangles == again.built.data.triangles);
  CHECK(one.built.data.sides == again.built.data.sides);
  CHECK(one.built.atlas.heights == again.built.atlas.heights);
}

}  // namespace spm::baker::octree_test
