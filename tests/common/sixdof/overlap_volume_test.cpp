// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/overlap_volume.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/paper/paper_volume.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::overlap_volume_test {
namespace {

using Eigen::Isometry3d;
using test::SparseCubeByHand;

constexpr double size = 0.04, small_size = 0.02;

struct Sampled {
  explicit Sampled(const SparseCubeByHand& cube, double spacing)
      : samples(*sample_surface(cube.view, spacing)), object{&cube.view, &samples} {}
  Sampled(const Sampled&) = delete;
  Sampled& operator=(const Sampled&) = delete;
  SurfaceSamples samples;
  SampledObject object;
};

Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

TEST_CASE("Two cubes share the box that lies in both, its middle and its faces") {
  const SparseCubeByHand large(size), small(small_size);
  const Sampled one(large, 0.0004), other(small, 0.0004);
  constexpr double depth = 0.003;
  const OverlapVolume overlap =
      overlap_volume(one.object, other.object, at(0.004, 0.002, (size + small_size) / 2 - depth));
  CHECK(overlap.volume == Approx(small_size * small_size * depth).epsilon(5e-3));
  CHECK((overlap.centre - Vector3(0.004, 0.002, size / 2 - depth / 2)).norm() < 2e-5);
  CHECK((overlap.push - Vector3(0, 0, small_size * small_size)).norm() <
        5e-3 * small_size * small_size);
  CHECK(overlap.contact_area == Approx(small_size * (small_size + 4 * depth)).epsilon(1e-2));
  const Wrench wrench = overlap_wrench(overlap, 1e12, {0.004, 0.002, 0.1});
  CHECK(wrench.force.z() == Approx(1e12 * overlap.volume * overlap.push.z()));
  CHECK(wrench.torque.norm() < 1e-2 * wrench.force.norm() * small_size);
}

TEST_CASE("A cube within another is wholly shared and pushed nowhere") {
  const SparseCubeByHand large(size), small(small_size);
  const Sampled one(large, 0.002), other(small, 0.0007);
  for (const bool turned : {false, true}) {
    const OverlapVolume overlap =
        turned ? overlap_volume(other.object, one.object, at(-0.001, 0.002, 0.003))
               : overlap_volume(one.object, other.object, at(0.001, -0.002, -0.003));
    CHECK(overlap.volume == Approx(std::pow(small_size, 3)).epsilon(1e-4));
    CHECK((overlap.centre - (turned ? Vector3::Zero() : Vector3(0.001, -0.002, -0.003))).norm() <
          1e-5);
    // Normals are kept in 30 bits.
    CHECK(overlap.push.norm() < 3e-4 * small_size * small_size);
  }
}

TEST_CASE("Cubes that are apart share nothing, and few samples are asked") {
  const SparseCubeByHand large(size), small(small_size);
  const Sampled one(large, 0.0004), other(small, 0.0004);
  const OverlapVolume overlap = overlap_volume(one.object, other.object, at(0.035, 0, 0));
  CHECK(overlap.volume == 0);
  CHECK(overlap.push.isZero());
  CHECK(overlap.tested < 3000);
}

TEST_CASE("The push and the turn are the slopes of the volume") {
  const SparseCubeByHand large(size), small(small_size);
  const Sampled one(large, 0.0004), other(small, 0.0004);
  const Isometry3d pose = at(0.006, -0.003, (size + small_size) / 2 - 0.001) *
                          Eigen::AngleAxisd(0.5, Vector3(3, -1, 0.5).normalized());
  const OverlapVolume overlap = overlap_volume(one.object, other.object, pose);
  const auto volume = [&](const Isometry3d& place) {
    return overlap_volume(one.object, other.object, place).volume;
  };
  REQUIRE(overlap.volume > 0);
  constexpr double step = 2e-4, angle = 0.01;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 unit = Vector3::Unit(axis);
    const double slope = (volume(Eigen::Translation3d(step * unit) * pose) -
                          volume(Eigen::Translation3d(-step * unit) * pose)) /
                         (2 * step);
    CHECK(-overlap.push[axis] == Approx(slope).margin(0.03 * overlap.push.norm()));
    const double turn = (volume(Eigen::AngleAxisd(angle, unit) * pose) -
                         volume(Eigen::AngleAxisd(-angle, unit) * pose)) /
                        (2 * angle);
    CHECK(-overlap.turn[axis] == Approx(turn).margin(0.03 * overlap.turn.norm()));
  }
}

/// The lower face of a cube as a `full` asset of one plane, tilted against the face.
class TiltedPlane {
 public:
  TiltedPlane(double edge, double tilt) {
    constexpr std::uint32_t samples = 801;
    const Vector3 down(std::sin(tilt), 0, -std::cos(tilt));
    const double wide = 2 * edge;
    SupportPlane plane = plane_with_normal(edge * down, down);
    plane.x0 -= wide / 2 * (plane.u + plane.v);
    by_hand_ = test::map_by_hand(0, samples, samples, 1, 0, 0, wide / (samples - 1),
                                 [&](std::uint32_t, double eta, double omega) {
                                   const Vector3 from = support_plane_point(plane, eta, omega);
                                   const double depth = (from.z() + edge / 2) / down.z();
                                   const Vector3 met = from - depth * down;
                                   const bool on_face = std::abs(met.x()) <= edge / 2 &&
                                                        std::abs(met.y()) <= edge / 2;
                                   return on_face ? depth : std::numeric_limits<double>::infinity();
                                 });
    by_hand_.map.samples = by_hand_.samples.data();
    by_hand_.map.layer_offsets = by_hand_.offsets.data();
    by_hand_.map.mask = by_hand_.mask.data();
    planes_ = {plane};
    maps_ = {by_hand_.map};
    view.full = true;
    view.planes = planes_;
    view.maps = maps_;
  }
  TiltedPlane(const TiltedPlane&) = delete;
  TiltedPlane& operator=(const TiltedPlane&) = delete;
  AssetView view;

 private:
  test::MapByHand by_hand_;
  std::vector<SupportPlane> planes_;
  std::vector<DistanceMap> maps_;
};

TEST_CASE(
    "The cosine of eq. 15 loses a quarter of a volume at 30 degrees and half at 45, and this "
    "none") {
  const SparseCubeByHand large(size), small(small_size);
  const Sampled one(large, 0.0005), other(small, 0.0005);
  const test::BoxByHand ground(Vector3::Constant(size));
  constexpr double depth = 0.003;
  const Isometry3d pose = at(0.001, 0.002, (size + small_size) / 2 - depth);
  const double wanted = small_size * small_size * depth;
  CHECK(overlap_volume(one.object, other.object, pose).volume == Approx(wanted).epsilon(5e-3));
  for (const auto& [degrees, kept] : {std::pair(30.0, 0.75), std::pair(45.0, 0.5)}) {
    const TiltedPlane tool(small_size, degrees * std::acos(-1.0) / 180);
    const auto by_maps = [&](AreaFactor factor) {
      return penetration_volume(ground.view, 4, tool.view, 0, pose, 1, factor).volume;
    };
    CHECK(by_maps(AreaFactor::paper) == Approx(kept * wanted).epsilon(0.02));
    CHECK(by_maps(AreaFactor::surface) == Approx(wanted).epsilon(0.02));
  }
}

TEST_CASE("Missing objects and poses that are no numbers share nothing") {
  const SparseCubeByHand cube(size);
  const Sampled one(cube, 0.002);
  CHECK(overlap_volume(one.object, {}, at(0, 0, 0)).volume == 0);
  CHECK(overlap_volume({}, one.object, at(0, 0, 0)).volume == 0);
  CHECK(overlap_volume(one.object, one.object, at(NAN, 0, 0)).volume == 0);
}

}  // namespace
}  // namespace spm::overlap_volume_test
