// SPDX-License-Identifier: Apache-2.0
#include "common/paper/smoothing.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/surface/distance_map.hpp"

namespace smoothing_test {

using namespace spm;

namespace {

constexpr std::uint32_t side = 81;
constexpr double spacing = 1e-4;
constexpr double sigma = 6e-4;

/// A map of one layer whose distance at a place is a function of its offset from the middle.
class Map {
 public:
  explicit Map(const std::function<double(double, double)>& distance) : samples_(side * side) {
    for (std::uint32_t j = 0; j < side; ++j) {
      for (std::uint32_t i = 0; i < side; ++i) {
        samples_[j * side + i] = static_cast<float>(distance(offset(i), offset(j)));
      }
    }
    map_.samples = samples_.data();
    map_.layer_offsets = &layer_;
    map_.columns = map_.rows = map_.row_stride = side;
    map_.layers = 1;
    map_.spacing = spacing;
  }

  /// Eq. 16 at the map's middle, over the samples that hit the surface.
  [[nodiscard]] GaussianWindow<double> filtered() const {
    GaussianWindow<double> window(sigma, 0);
    for (std::uint32_t j = 0; j < side; ++j) {
      for (std::uint32_t i = 0; i < side; ++i) {
        const double distance = map_.at(0, i, j);
        if (!std::isfinite(distance)) continue;
        window.add(offset(i), offset(j), spacing * spacing, distance);
      }
    }
    return window;
  }

 private:
  static double offset(std::uint32_t index) {
    return spacing * (static_cast<double>(index) - side / 2);
  }

  std::vector<float> samples_;
  std::uint32_t layer_ = 0;
  DistanceMap map_;
};

}  // namespace

TEST_CASE("A Gaussian kernel is round and falls as its formula says") {
  const double top = gaussian_kernel(sigma, 0, 0);
  CHECK(top == Approx(1 / (2 * 3.141592653589793 * sigma * sigma)));
  CHECK(gaussian_kernel(sigma, sigma, 0) == Approx(top * std::exp(-0.5)));
  CHECK(gaussian_kernel(sigma, 0.6 * sigma, -0.8 * sigma) == Approx(top * std::exp(-0.5)));
}

TEST_CASE("A map that covers the kernel has all of its weight") {
  CHECK(Map([](double, double) { return 0.01; }).filtered().weight() == Approx(1).epsilon(1e-6));
}

TEST_CASE("The filter leaves a plane where it is") {
  const Map map([](double eta, double omega) { return 0.01 + 0.3 * eta - 0.7 * omega; });
  CHECK(map.filtered().value() == Approx(0.01).epsilon(1e-6));
}

TEST_CASE("The filter moves a paraboloid by the variance over its radius") {
  const double radius = 0.02;
  const Map map(
      [&](double eta, double omega) { return (eta * eta + omega * omega) / (2 * radius); });
  CHECK(map.filtered().value() == Approx(sigma * sigma / radius).epsilon(1e-5));
}

TEST_CASE("The filter damps a wave by its transfer function") {
  const double turns = 1500;  // rad/m
  const Map map([&](double eta, double) { return std::cos(turns * eta); });
  CHECK(map.filtered().value() == Approx(std::exp(-0.5 * std::pow(sigma * turns, 2))));
}

TEST_CASE("What lies beyond a silhouette does not count") {
  const Map map([](double eta, double) { return eta > 3e-4 ? no_hit : 0.01; });
  CHECK(map.filtered().weight() < 0.8);
  CHECK(map.filtered().value() == Approx(0.01).epsilon(1e-6));
}

}  // namespace smoothing_test
