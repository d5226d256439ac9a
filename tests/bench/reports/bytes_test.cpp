// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/bytes.hpp"

#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "tests/baker/verify/verify_shapes.hpp"
#include "tests/bench/model/places.hpp"
#include "tests/support/shapes.hpp"

namespace bytes_test {

namespace {

using namespace spm;
using namespace spm::bench;

const Vector3 box_size(0.02, 0.016, 0.012);

Model box_model() { return {{"box", "box", 100e-6}, test::as_mesh(test::box(box_size))}; }

/// Answers what a function says.
class Told : public Method {
 public:
  explicit Told(std::function<Answer(const Vector3&)> tell, double tolerance = 0)
      : tell_(std::move(tell)) {
    facts_.tolerance = tolerance;
  }
  [[nodiscard]] Answer query(const Vector3& point) const noexcept override { return tell_(point); }

 private:
  std::function<Answer(const Vector3&)> tell_;
};

Answer told(double distance, const Vector3& normal) {
  Answer answer;
  answer.distance = distance;
  answer.normal = normal;
  answer.status = Status::exact;
  return answer;
}

MethodRow row(const char* method, double setting, std::uint64_t bytes, double p99) {
  MethodRow result;
  result.model = "box";
  result.facts.name = method;
  result.facts.setting = setting;
  result.facts.resident_bytes = bytes;
  result.score.p99 = p99;
  return result;
}

}  // namespace

TEST_CASE("Places lie in the band, the same for any number of threads") {
  const Model model = box_model();
  const Places places = draw_places(model, 500, 3);
  REQUIRE(places.places.size() == 500);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Places again = draw_places(model, 500, 3);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < places.places.size(); ++i) {
    const Place& place = places.places[i];
    CHECK(place.point == again.places[i].point);
    const Vector3 beyond = place.point.cwiseAbs() - box_size / 2;
    const double distance = beyond.cwiseMax(0).norm() + std::min(beyond.maxCoeff(), 0.0);
    CHECK(place.distance == Approx(distance).margin(1e-12));
    CHECK(distance >= -model.band.max_depth);
    CHECK(distance <= model.band.margin);
    inside += distance < 0 ? 1 : 0;
  }
  // Depths are uniform: four fifths of the band are inside.
  CHECK(inside > 350);
  CHECK(inside < 450);
}

TEST_CASE("A score tells how far answers are from the truth") {
  const Model model = box_model();
  const Places places = draw_places(model, 500, 3);
  const auto truth = [&](const Vector3& point) {
    const auto answer = model.caster.closest(point);
    return told(answer.distance, answer.direction);
  };
  const Score exact = score(Told(truth), model, places);
  CHECK(exact.max < 1e-12);
  CHECK(exact.direction_p99 < 1e-7);
  CHECK(exact.misclassified == 0);
  CHECK(exact.unanswered == 0);

  const Score shifted = score(Told([&](const Vector3& point) {
                                Answer answer = truth(point);
                                answer.distance += 5e-6;
                                return answer;
                              }),
                              model, places);
  CHECK(shifted.p50 == Approx(5e-6));
  CHECK(shifted.p99 == Approx(5e-6));
  CHECK(shifted.max == Approx(5e-6));
  CHECK(shifted.misclassified == 0);

  const Score turned = score(Told([&](const Vector3& point) {
                               const Answer answer = truth(point);
                               return told(-answer.distance, -answer.normal);
                             }),
                             model, places);
  CHECK(turned.misclassified == 1);
  CHECK(turned.direction_p50 == Approx(std::acos(-1.0)));

  const Score silent =
      score(Told([](const Vector3&) {
              return told(std::numeric_limits<double>::quiet_NaN(), Vector3::Zero());
            }),
            model, places);
  CHECK(silent.unanswered == 1);
}

TEST_CASE("A side is judged by the tolerance that a method was built for, where it has one") {
  const Model model = box_model();
  const Places places = draw_places(model, 500, 3);
  // Wrong up to 0.3 mm off the surface; the model's own tolerance is 0.1 mm.
  const auto careless = [&](const Vector3& point) {
    const double distance = model.caster.closest(point).distance;
    return told(std::abs(distance) < 0.3e-3 ? -distance : distance, Vector3::Zero());
  };
  CHECK(score(Told(careless), model, places).misclassified > 0);
  CHECK(score(Told(careless, 0.2e-3), model, places).misclassified > 0);
  CHECK(score(Told(careless, 0.4e-3), model, places).misclassified == 0);
}

TEST_CASE("The size for an error follows the settings straight on logarithmic scales") {
  // Bytes as the error to the power -2.
  const std::vector<SizeAndError> settings{{1e6, 100e-6}, {100e6, 10e-6}, {4e6, 50e-6}};
  const auto between = size_at_error(settings, 20e-6, 1e-8);
  REQUIRE(between);
  CHECK(between->bytes == Approx(25e6));
  CHECK(between->slope == Approx(-2));
  CHECK(between->estimate == Estimate::interpolated);
  const auto beyond = size_at_error(settings, 5e-6, 1e-8);
  REQUIRE(beyond);
  CHECK(beyond->bytes == Approx(400e6));
  CHECK(beyond->estimate == Estimate::extrapolated);
  const auto before = size_at_error(settings, 200e-6, 1e-8);
  REQUIRE(before);
  CHECK(before->bytes == Approx(0.25e6));
  CHECK(before->estimate == Estimate::extrapolated);
}

TEST_CASE("A method without error is taken at its smallest setting") {
  const auto size = size_at_error({{5e6, 1e-9}, {2e6, 2e-9}, {1e6, 1e-6}}, 20e-6, 1e-8);
  REQUIRE(size);
  CHECK(size->bytes == 2e6);
  CHECK(size->estimate == Estimate::measured);
}

TEST_CASE("Settings that do not tell give no size") {
  CHECK_FALSE(size_at_error({{1e6, 100e-6}}, 20e-6, 1e-8));
  CHECK_FALSE(size_at_error({{1e6, 100e-6}, {2e6, 110e-6}}, 20e-6, 1e-8));
}

TEST_CASE("Methods are compared at the error of the product at the model's own tolerance") {
  ModelRow model;
  model.name = "box";
  model.tolerance = 100e-6;
  const std::vector<MethodRow> rows{
      row("spm", 50e-6, 2000000, 12e-6), row("spm", 100e-6, 1000000, 20e-6),
      row("dense-sdf", 1e-3, 1000000, 100e-6), row("dense-sdf", 0.5e-3, 4000000, 50e-6)};
  const std::vector<ComparisonRow> comparisons = compare_bytes({model}, rows);
  REQUIRE(comparisons.size() == 1);
  CHECK(comparisons[0].method == "dense-sdf");
  CHECK(comparisons[0].error == 20e-6);
  CHECK(comparisons[0].spm_bytes == 1000000);
  REQUIRE(comparisons[0].size);
  CHECK(comparisons[0].size->bytes == Approx(25e6));
}

}  // namespace bytes_test
