// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_volume.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::paper_volume_test {
namespace {

using test::map_by_hand;
using test::MapByHand;

constexpr double nothing = std::numeric_limits<double>::infinity();

/// A `full` asset of one plane about a point with a normal. Its map is a square of this width; its
/// depths are a function of the distances from its middle.
class OnePlane {
 public:
  OnePlane(const Vector3& middle, const Vector3& normal, double wide,
           const std::function<double(double, double)>& depth, std::uint32_t samples = 201) {
    SupportPlane plane = plane_with_normal(middle, normal);
    plane.x0 += -wide / 2 * plane.u - wide / 2 * plane.v;
    made_ = map_by_hand(0, samples, samples, 1, 0, 0, wide / (samples - 1),
                        [=](std::uint32_t, double eta, double omega) {
                          return depth(eta - wide / 2, omega - wide / 2);
                        });
    planes_ = {plane};
    made_.map.samples = made_.samples.data();
    made_.map.layer_offsets = made_.offsets.data();
    made_.map.mask = made_.mask.data();
    maps_ = {made_.map};
    view.full = true;
    view.planes = planes_;
    view.maps = maps_;
  }
  OnePlane(const OnePlane&) = delete;
  OnePlane& operator=(const OnePlane&) = delete;

  AssetView view;

 private:
  MapByHand made_;
  std::vector<SupportPlane> planes_;
  std::vector<DistanceMap> maps_;
};

constexpr double radius = 0.02;

/// The near half of a ball about the origin, seen along a normal.
double ball(double x, double y) {
  const double square = radius * radius - x * x - y * y;
  return square > 0 ? radius - std::sqrt(square) : nothing;
}

Eigen::Isometry3d moved(const Vector3& by) { return Eigen::Isometry3d(Eigen::Translation3d(by)); }

PenetrationVolume ball_in_ground(double tilt, double height, AreaFactor factor) {
  const OnePlane ground(Vector3::Zero(), Vector3::UnitZ(), 0.1, [](double, double) { return 0; });
  const Vector3 down(std::sin(tilt), 0, -std::cos(tilt));
  const OnePlane tool(radius * down, down, 0.0399, ball);
  return penetration_volume(ground.view, 0, tool.view, 0, moved({0.003, -0.002, height}), 1000,
                            factor);
}

TEST_CASE("f is how far a point lies under the other surface (eq. 13)") {
  const OnePlane ground(Vector3(0, 0, 0.01), Vector3::UnitZ(), 0.1,
                        [](double, double) { return 0.004; });
  CHECK(penetration_function(ground.view, 0, {0.01, 0.02, 0.005}) == Approx(0.001));
  CHECK(penetration_function(ground.view, 0, {0.01, 0.02, 0.007}) == Approx(-0.001));
  CHECK(std::isnan(penetration_function(ground.view, 0, {1, 0, 0.005})));
  CHECK(std::isnan(penetration_function(ground.view, 1, {0, 0, 0.005})));
}

TEST_CASE("Beside a surface's edge the sample stands for it that is nearest along both axes") {
  constexpr double wide = 0.02, spacing = wide / 2;
  // The corners of a cell of one map, of which the last met nothing; m.
  const OnePlane ground(
      Vector3::Zero(), Vector3::UnitZ(), wide,
      [](double x, double y) -> double {
        if (x > -spacing / 2 && y > -spacing / 2) return nothing;
        return 0.001 + (x > -spacing / 2 ? 0.001 : 0) + (y > -spacing / 2 ? 0.002 : 0);
      },
      3);
  const SupportPlane& plane = ground.view.planes[0];
  const auto f = [&](double eta, double omega) {
    return penetration_function(
        ground.view, 0, plane.x0 + spacing * (eta * plane.u + omega * plane.v) - 0.005 * plane.n);
  };
  CHECK(f(0.2, 0.2) == Approx(0.004));
  CHECK(f(0.8, 0.2) == Approx(0.003));
  CHECK(f(0.2, 0.8) == Approx(0.002));
  CHECK_FALSE(f(0.8, 0.8) > 0);
}

TEST_CASE("A box pressed flat into the ground shares its face times the depth (eq. 15)") {
  const OnePlane ground(Vector3::Zero(), Vector3::UnitZ(), 0.1, [](double, double) { return 0; });
  const OnePlane box(Vector3::Zero(), -Vector3::UnitZ(), 0.02, [](double, double) { return 0; });
  for (const AreaFactor factor : {AreaFactor::paper, AreaFactor::surface}) {
    const PenetrationVolume found =
        penetration_volume(ground.view, 0, box.view, 0, moved({0.01, 0, -0.002}), 500, factor);
    CHECK(found.volume == Approx(0.02 * 0.02 * 0.002));
    CHECK(found.mass == Approx(500 * found.volume));
    CHECK((found.centre - Vector3(0.01, 0, -0.001)).norm() < 1e-9);
    CHECK((found.normal - Vector3::UnitZ()).norm() < 1e-9);
  }
}

TEST_CASE("Two boxes share what their faces have in common, times the depth") {
  const auto flat = [](double, double) { return 0; };
  const OnePlane lower(Vector3::Zero(), Vector3::UnitZ(), 0.04, flat);
  const OnePlane upper(Vector3::Zero(), -Vector3::UnitZ(), 0.02, flat);
  for (const AreaFactor factor : {AreaFactor::paper, AreaFactor::surface}) {
    const PenetrationVolume found =
        penetration_volume(lower.view, 0, upper.view, 0, moved({0.015, 0.013, -0.0007}), 1, factor);
    // From x = 5 mm and y = 3 mm on, up to the lower one's edges.
    CHECK(found.area == Approx(0.015 * 0.017));
    CHECK(found.volume == Approx(0.015 * 0.017 * 0.0007));
    CHECK((found.centre - Vector3(0.0125, 0.0115, -0.00035)).norm() < 1e-9);
  }
}

/// A flat square in a wider, coarse map.
double square(double half, double x, double y) {
  return std::max(std::abs(x), std::abs(y)) <= half ? 0 : nothing;
}

TEST_CASE("Where coarse maps end beside a surface's edge the volume is that of the surface") {
  constexpr double deep = 0.001, wide = 0.05;
  constexpr std::uint32_t samples = 33;
  constexpr double spacing = wide / (samples - 1);
  // All of the small face, and then a part of it; the mean over where the edges lie in the maps.
  for (const double from : {0.0, 0.012}) {
    double volume = 0, wanted = 0;
    for (int i = 0; i < 500; ++i) {
      const double half = 0.0105 + spacing * std::fmod(i * 0.8191725134, 1.0);
      const double wider = 0.0157 + spacing * std::fmod(i * 0.4503027155, 1.0);
      const Vector3 by(from + spacing * std::fmod(i * 0.6710436067, 1.0),
                       -from - spacing * std::fmod(i * 0.5497004779, 1.0), -deep);
      const OnePlane small(
          Vector3::Zero(), -Vector3::UnitZ(), wide,
          [=](double x, double y) { return square(half, x, y); }, samples);
      const OnePlane large(
          Vector3::Zero(), Vector3::UnitZ(), wide,
          [=](double x, double y) { return square(wider, x, y); }, samples);
      volume +=
          penetration_volume(large.view, 0, small.view, 0, moved(by), 1, AreaFactor::paper).volume;
      wanted += deep * std::min(2 * half, half + wider - by.x()) *
                std::min(2 * half, half + wider + by.y());
    }
    CHECK(volume == Approx(wanted).epsilon(0.02));
  }
}

TEST_CASE("Two balls share a lens, by planes that look at one another") {
  const OnePlane lower(Vector3(0, 0, radius), Vector3::UnitZ(), 0.0399, ball);
  const OnePlane upper(Vector3(0, 0, -radius), -Vector3::UnitZ(), 0.0399, ball);
  for (const double overlap : {0.002, 0.006}) {
    const double apart = 2 * radius - overlap;
    const double lens = std::numbers::pi / 12 * (4 * radius + apart) * overlap * overlap;
    const double disc = std::numbers::pi * (radius * radius - apart * apart / 4);
    for (const AreaFactor factor : {AreaFactor::paper, AreaFactor::surface}) {
      const PenetrationVolume found =
          penetration_volume(lower.view, 0, upper.view, 0, moved({0, 0, apart}), 1, factor);
      CHECK(found.volume == Approx(lens).epsilon(0.01));
      CHECK(found.area == Approx(disc).epsilon(0.02));
      CHECK((found.centre - Vector3(0, 0, apart / 2)).norm() < 0.02 * overlap);
    }
  }
}

TEST_CASE("A ball in the ground shares a cap, by a plane that looks straight down") {
  const double depth = 0.006;
  const double cap = std::numbers::pi * depth * depth * (3 * radius - depth) / 3;
  for (const AreaFactor factor : {AreaFactor::paper, AreaFactor::surface}) {
    CHECK(ball_in_ground(0, radius - depth, factor).volume == Approx(cap).epsilon(0.005));
  }
  const PenetrationVolume found = ball_in_ground(0, radius - depth, AreaFactor::surface);
  const double under = 3 * std::pow(2 * radius - depth, 2) / (4 * (3 * radius - depth));
  CHECK((found.centre - Vector3(0.003, -0.002, radius - depth - under)).norm() < 5e-5);
}

TEST_CASE("By a tilted plane the paper's cosine is wrong, the surface's own projection is not") {
  const double depth = 0.006;
  const double cap = std::numbers::pi * depth * depth * (3 * radius - depth) / 3;
  const double tilt = 20 * std::numbers::pi / 180;
  const PenetrationVolume exact = ball_in_ground(tilt, radius - depth, AreaFactor::surface);
  CHECK(exact.volume == Approx(cap).epsilon(0.005));
  const PenetrationVolume paper = ball_in_ground(tilt, radius - depth, AreaFactor::paper);
  CHECK(std::abs(paper.volume / cap - 1) > 0.05);
}

TEST_CASE("The force is at the centre of gravity, with its torque about a point") {
  const PenetrationVolume found = ball_in_ground(0, 0.015, AreaFactor::surface);
  const Vector3 about(0.013, -0.002, 0.1);
  const Wrench wrench = volume_wrench(found, 1e6, about);
  CHECK(wrench.force.z() == Approx(1e6 * found.volume));
  CHECK(std::hypot(wrench.force.x(), wrench.force.y()) < 1e-6 * wrench.force.z());
  // The ball is 10 mm to the left of the point: pushed up, it turns about +y.
  CHECK(wrench.torque.y() == Approx(0.01 * wrench.force.z()).epsilon(1e-3));
}

TEST_CASE("Objects apart, or without maps, share nothing") {
  CHECK(ball_in_ground(0, 2 * radius, AreaFactor::paper).volume == 0);
  CHECK(ball_in_ground(0, 2 * radius, AreaFactor::surface).samples == 0);
  const AssetView none;
  const PenetrationVolume found = penetration_volume(
      none, 0, none, 0, Eigen::Isometry3d::Identity(), 1000, AreaFactor::surface);
  CHECK(found.volume == 0);
  CHECK(volume_wrench(found, 1e6, Vector3::Zero()).force.isZero());
}

TEST_CASE("A pose that is no number shares nothing") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const OnePlane ground(Vector3::Zero(), Vector3::UnitZ(), 0.1, [](double, double) { return 0; });
  const OnePlane tool(Vector3(0, 0, -radius), -Vector3::UnitZ(), 0.0399, ball);
  const PenetrationVolume found = penetration_volume(ground.view, 0, tool.view, 0,
                                                     moved({nan, 0, 0}), 1000, AreaFactor::surface);
  CHECK(found.volume == 0);
  CHECK(found.centre.isZero());
}

TEST_CASE("With a stride areas stay right, also where it does not divide the map") {
  const OnePlane ground(Vector3::Zero(), Vector3::UnitZ(), 0.1, [](double, double) { return 0; });
  const Vector3 down(0, 0, -1);
  const OnePlane box(
      Vector3::Zero(), down, 0.03, [](double, double) { return 0; }, 18);
  const OnePlane round(radius * down, down, 0.0399, ball);
  const PenetrationVolume all =
      penetration_volume(ground.view, 0, round.view, 0, moved({0, 0, 0.015}), 1, AreaFactor::paper);
  for (const std::uint32_t stride : {1U, 2U, 3U, 4U, 8U}) {
    INFO("stride " << stride);
    const PenetrationVolume flat = penetration_volume(
        ground.view, 0, box.view, 0, moved({0, 0, -0.002}), 1, AreaFactor::paper, stride);
    CHECK(flat.area == Approx(0.03 * 0.03));
    CHECK(flat.volume == Approx(0.03 * 0.03 * 0.002));
    CHECK(flat.centre.head<2>().norm() < 1e-9);
    CHECK(flat.samples == strided_cells(18, 18, stride));
    const PenetrationVolume some = penetration_volume(
        ground.view, 0, round.view, 0, moved({0, 0, 0.015}), 1, AreaFactor::paper, stride);
    CHECK(some.area == Approx(all.area).epsilon(0.02 * stride));
    CHECK(some.volume == Approx(all.volume).epsilon(0.02 * stride));
  }
}

}  // namespace
}  // namespace spm::paper_volume_test
