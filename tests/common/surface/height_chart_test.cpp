// SPDX-License-Identifier: Apache-2.0
// Eq. 3 to 5 on a chart of heights between which a biquadratic spline goes.
#include "common/surface/height_chart.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/random.hpp"

namespace spm::height_chart_test {
namespace {

constexpr std::uint16_t side = 12;
constexpr double spacing = 1e-3;

/// D_SP = base + slope . p + p' bend p / 2 over a plane, m.
struct Paraboloid {
  double base = 0.01;
  double eta = 0, omega = 0, eta_eta = 0, eta_omega = 0, omega_omega = 0;

  [[nodiscard]] double at(double x, double y) const {
    return base + eta * x + omega * y + (eta_eta * x * x + omega_omega * y * y) / 2 +
           eta_omega * x * y;
  }
};

/// A chart of a paraboloid, whose coefficients are its values less an eighth of both second
/// differences.
struct Made {
  std::vector<float> heights;
  HeightChart chart;

  Made(const SupportPlane& plane, const Paraboloid& surface) {
    const double less = (surface.eta_eta + surface.omega_omega) * spacing * spacing / 8;
    for (std::uint32_t row = 0; row < side + 1; ++row) {
      for (std::uint32_t column = 0; column < side; ++column) {
        heights.push_back(
            static_cast<float>(surface.at(spacing * (column - 5.0), spacing * (row - 4.0)) - less));
      }
    }
    chart = chart_on(plane, spacing, -5, -4);
    chart.heights = std::span<const float>(heights);
    chart.stride = chart.columns = chart.rows = side;
  }
};

}  // namespace

TEST_CASE("On a paraboloid a chart tells eq. 3 exactly, and eq. 5 its normal") {
  test::RandomTwister random(3);
  for (int k = 0; k < 200; ++k) {
    const Vector3 normal(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    const SupportPlane plane = plane_with_normal({0.03, -0.02, 0.05}, normal.normalized());
    Paraboloid surface;
    surface.eta = random.between(-0.5, 0.5);
    surface.omega = random.between(-0.5, 0.5);
    surface.eta_eta = random.between(-50, 50);
    surface.eta_omega = random.between(-50, 50);
    surface.omega_omega = random.between(-50, 50);
    const Made made(plane, surface);
    const double eta = random.between(-3e-3, 5e-3), omega = random.between(-2e-3, 6e-3);
    const double depth = random.between(0, 0.02);
    const Vector3 place = support_plane_point(plane, eta, omega) - depth * plane.n;
    MapContact contact;
    REQUIRE(contact_on(made.chart, place, contact));
    CHECK(contact.penetration == Approx(depth - surface.at(eta, omega)).margin(2e-8));
    const double by_eta = surface.eta + surface.eta_eta * eta + surface.eta_omega * omega;
    const double by_omega = surface.omega + surface.eta_omega * eta + surface.omega_omega * omega;
    const Vector3 expected = plane.n + by_eta * plane.u + by_omega * plane.v;
    CHECK((contact.normal - expected).norm() < 2e-5);
    // By differences of the distance, where the surface itself is.
    const Vector3 foot = support_plane_point(plane, eta, omega) - surface.at(eta, omega) * plane.n;
    const double w = 1 / std::sqrt(1 + by_eta * by_eta + by_omega * by_omega);
    const double bend =
        w * (surface.eta_eta + surface.omega_omega) -
        2 * w * w * w *
            (by_eta * by_eta * surface.eta_eta + 2 * by_eta * by_omega * surface.eta_omega +
             by_omega * by_omega * surface.omega_omega);
    CHECK(bend_on(made.chart, foot) == Approx(bend).margin(0.2));
  }
}

TEST_CASE("A place whose projection is not on a chart gets no answer of it") {
  const SupportPlane plane;
  const Made made(plane, {});
  MapContact contact;
  const auto is_on = [&](double eta, double omega) {
    return contact_on(made.chart, Vector3(eta, omega, -0.01), contact);
  };
  CHECK(is_on(0, 0));
  // Half a spacing from the outermost heights but one.
  CHECK(is_on(-4.4 * spacing, 0));
  CHECK_FALSE(is_on(-4.6 * spacing, 0));
  CHECK(is_on(5.4 * spacing, 6.4 * spacing));
  CHECK_FALSE(is_on(5.6 * spacing, 6.4 * spacing));
  CHECK_FALSE(is_on(0, 6.6 * spacing));
  CHECK_FALSE(is_on(0, -3.6 * spacing));
  CHECK_FALSE(is_on(1e9, -1e9));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(is_on(nan, 0));
  CHECK_FALSE(is_on(0, std::numeric_limits<double>::infinity()));
}

TEST_CASE("Across the lattice's cells a chart's distance and normal go on without a step") {
  test::RandomTwister random(5);
  Made made(SupportPlane(), {});
  for (float& height : made.heights) height += static_cast<float>(random.between(-1e-4, 1e-4));
  for (int k = 0; k < 100; ++k) {
    const double along = random.between(-3e-3, 5e-3);
    const double border = spacing * (std::floor(random.between(-3, 5)) + 0.5);
    MapContact before, after;
    REQUIRE(contact_on(made.chart, {border - 1e-12, along, -0.01}, before));
    REQUIRE(contact_on(made.chart, {border + 1e-12, along, -0.01}, after));
    CHECK(before.penetration == Approx(after.penetration).margin(1e-9));
    CHECK((before.normal - after.normal).norm() < 1e-5);
  }
}

TEST_CASE("Heights that are HALF samples answer as the same ones that are FLOAT") {
  test::RandomTwister random(7);
  Made made(plane_with_normal({0.01, 0.02, 0.03}, Vector3(1, 2, 3).normalized()), {});
  std::vector<std::uint16_t> halves;
  for (float& height : made.heights) {
    halves.push_back(half_of(height + static_cast<float>(random.between(-1e-3, 1e-3))));
    height = float_of_half(halves.back());
  }
  HeightChart chart = made.chart;
  chart.heights = std::span<const std::uint16_t>(halves);
  for (int k = 0; k < 200; ++k) {
    const Vector3 place(random.between(-0.02, 0.04), random.between(-0.02, 0.04),
                        random.between(-0.02, 0.04));
    MapContact of_floats, of_halves;
    REQUIRE(contact_on(made.chart, place, of_floats) == contact_on(chart, place, of_halves));
    CHECK(of_floats.penetration == of_halves.penetration);
    CHECK(of_floats.normal == of_halves.normal);
  }
}

TEST_CASE("Heights below a base tell what those below the support plane do") {
  test::RandomTwister random(9);
  const SupportPlane plane = plane_with_normal({0.01, 0.02, 0.03}, Vector3(3, -2, 1).normalized());
  Paraboloid surface;
  surface.eta_eta = 30;
  surface.omega_omega = -20;
  const Made relief(plane, surface);
  constexpr double base = 0.004;
  surface.base += base;
  const Made whole(plane, surface);
  HeightChart chart = chart_on(plane, spacing, -5, -4, base);
  chart.heights = std::span<const float>(relief.heights);
  chart.stride = chart.columns = chart.rows = side;
  for (int k = 0; k < 200; ++k) {
    const Vector3 place =
        support_plane_point(plane, random.between(-3e-3, 5e-3), random.between(-2e-3, 6e-3)) -
        random.between(0, 0.02) * plane.n;
    MapContact of_whole, of_relief;
    REQUIRE(contact_on(whole.chart, place, of_whole));
    REQUIRE(contact_on(chart, place, of_relief));
    CHECK(of_whole.penetration == Approx(of_relief.penetration).margin(2e-8));
    CHECK((of_whole.normal - of_relief.normal).norm() < 2e-5);
  }
}

}  // namespace spm::height_chart_test
