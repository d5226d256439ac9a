// SPDX-License-Identifier: Apache-2.0
#include "common/paper/map_noise.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/support/asset_by_hand.hpp"

namespace spm::map_noise_test {
namespace {

constexpr double size = 0.04;

/// The place under a sample of a plane's map, or between samples.
Vector3 under(const AssetView& asset, std::size_t plane, double column, double row,
              double depth = 0.001) {
  const DistanceMap& map = asset.maps[plane];
  return reconstructed_surface(asset.planes[plane], map.eta0 + column * map.spacing,
                               map.omega0 + row * map.spacing, depth);
}

TEST_CASE("Noise at the samples of a map is Gaussian, of mean 0 and deviation 1 (eq. 19)") {
  const test::BoxByHand box({size, size, size});
  double sum = 0, squares = 0, fourths = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (std::size_t plane = 0; plane < 6; ++plane) {
      for (int row = 0; row < 16; ++row) {
        for (int column = 0; column < 16; ++column) {
          const double noise =
              map_noise(box.view, plane, under(box.view, plane, column, row), seed);
          sum += noise;
          squares += noise * noise;
          fourths += noise * noise * noise * noise;
          ++count;
        }
      }
    }
  }
  CHECK(sum / count == Approx(0).margin(0.02));
  CHECK(squares / count == Approx(1).epsilon(0.03));
  CHECK(fourths / count == Approx(3).epsilon(0.1));
}

TEST_CASE("Noise is a part of the map: bilinear between samples, and the same at any depth") {
  const test::BoxByHand box({size, size, size});
  const auto at = [&](double column, double row, double depth = 0.001) {
    return map_noise(box.view, 2, under(box.view, 2, column, row, depth), 7);
  };
  CHECK(at(4.5, 9) == Approx((at(4, 9) + at(5, 9)) / 2));
  CHECK(at(4, 9.25) == Approx(0.75 * at(4, 9) + 0.25 * at(4, 10)));
  CHECK(at(4.5, 9.5) == Approx((at(4, 9) + at(5, 9) + at(4, 10) + at(5, 10)) / 4));
  CHECK(at(4.3, 9.8, 0.002) == Approx(at(4.3, 9.8, 0)));
}

TEST_CASE("Another seed, plane or sample has other noise, the same have the same") {
  const test::BoxByHand box({size, size, size});
  const Vector3 place = under(box.view, 0, 3, 5);
  const double noise = map_noise(box.view, 0, place, 1);
  CHECK(map_noise(box.view, 0, place, 1) == noise);
  CHECK(std::abs(map_noise(box.view, 0, place, 2) - noise) > 1e-3);
  CHECK(std::abs(map_noise(box.view, 0, under(box.view, 0, 5, 3), 1) - noise) > 1e-3);
  CHECK(std::abs(map_noise(box.view, 1, under(box.view, 1, 3, 5), 1) - noise) > 1e-3);
}

TEST_CASE("Beside a map, on no plane and nowhere there is no noise") {
  const test::BoxByHand box({size, size, size});
  CHECK(map_noise(box.view, 0, under(box.view, 0, -1, 5), 1) == 0);
  CHECK(map_noise(box.view, 6, Vector3::Zero(), 1) == 0);
  CHECK(map_noise(box.view, 0, Vector3::Constant(std::numeric_limits<double>::quiet_NaN()), 1) ==
        0);
  CHECK(map_noise(AssetView{}, 0, Vector3::Zero(), 1) == 0);
}

}  // namespace
}  // namespace spm::map_noise_test
