// SPDX-License-Identifier: Apache-2.0
#include "common/paper/paper_probe_force.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "common/paper/probe_footprint.hpp"
#include "common/surface/support_plane_mapping.hpp"
#include "tests/support/asset_by_hand.hpp"

namespace spm::paper_probe_force_test {
namespace {

using test::map_by_hand;
using test::MapByHand;

constexpr double stiffness = 1000;
constexpr double radius = 0.01;

/// A half-space under z = 0, seen by one plane at z = 0.01 with samples every 0.25 mm: so that the
/// surface is not the plane itself.
class Ground {
 public:
  explicit Ground(double slope = 0)
      : Ground([=](double x, double /*y*/) { return 0.01 + slope * x; }) {}
  /// What lies under the plane by a distance over x and y.
  explicit Ground(const std::function<double(double, double)>& distance) {
    SupportPlane plane = plane_with_normal({0, 0, 0.01}, Vector3::UnitZ());
    plane.x0 += -0.03 * plane.u - 0.03 * plane.v;
    made_ = map_by_hand(0, 241, 241, 1, 0, 0, 2.5e-4, [&](std::uint32_t, double eta, double omega) {
      return distance(eta - 0.03, omega - 0.03);
    });
    planes_ = {plane};
    made_.map.samples = made_.samples.data();
    made_.map.layer_offsets = made_.offsets.data();
    made_.map.mask = made_.mask.data();
    maps_ = {made_.map};
    n_ = {plane.n.x(), plane.n.y(), plane.n.z(), plane.n.dot(plane.x0)};
    view.full = true;
    view.planes = planes_;
    view.maps = maps_;
    view.plane_nx = {&n_[0], 1};
    view.plane_ny = {&n_[1], 1};
    view.plane_nz = {&n_[2], 1};
    view.plane_offset = {&n_[3], 1};
  }
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;

  AssetView view;
  [[nodiscard]] const SupportPlane& plane() const { return planes_[0]; }

 private:
  MapByHand made_;
  std::vector<SupportPlane> planes_;
  std::vector<DistanceMap> maps_;
  std::vector<double> n_;
};

TEST_CASE("A sphere half in the ground feels the mean depth of its lower side (eq. 10, 11)") {
  const Ground ground;
  const PaperProbeForce found =
      paper_probe_force(ground.view, SphereProbe({0, 0, 0}, radius), stiffness);
  // The mean of sqrt(r^2 - rho^2) over a disc is 2 r / 3.
  CHECK(found.force.z() == Approx(stiffness * 2 * radius / 3).epsilon(0.01));
  // At the rim both sides are at the surface, but for rounding.
  CHECK(found.far.z() == Approx(found.force.z()).epsilon(0.005));
  CHECK(found.near_count < found.far_count / 200);
  CHECK(found.far_count == Approx(most_probe_samples).epsilon(0.02));
  CHECK(std::hypot(found.force.x(), found.force.y()) < 1e-9);
}

TEST_CASE("A sphere wholly in the ground feels its centre's depth, from both sides alike") {
  const Ground ground;
  const PaperProbeForce found =
      paper_probe_force(ground.view, SphereProbe({0, 0, -0.015}, radius), stiffness);
  CHECK(found.force.z() == Approx(stiffness * 0.015));
  CHECK(found.near_count == found.far_count);
  CHECK(found.far.z() - found.near.z() == Approx(stiffness * 4 * radius / 3).epsilon(0.02));
}

TEST_CASE("The form over the volume is the mean depth of what is in the ground") {
  const Ground ground;
  // The mean depth of half a ball is 3 r / 8; that of a whole ball is its centre's depth.
  CHECK(paper_probe_volume_force(ground.view, SphereProbe({0, 0, 0}, radius), stiffness).z() ==
        Approx(stiffness * 3 * radius / 8).epsilon(0.01));
  CHECK(paper_probe_volume_force(ground.view, SphereProbe({0, 0, -0.02}, radius), stiffness).z() ==
        Approx(stiffness * 0.02));
}

TEST_CASE("A capsule that lies half in the ground feels a cylinder's mean depth") {
  const Ground ground;
  constexpr double thin = 0.006125;
  const CapsuleProbe capsule({-0.015, 0, 0}, {0.015, 0, 0}, thin);
  const double straight = 0.03 * 2 * thin, ends = std::numbers::pi * thin * thin;
  // The mean is pi r / 4 over the strip, and 2 r / 3 over the two half discs.
  const double mean =
      (straight * std::numbers::pi * thin / 4 + ends * 2 * thin / 3) / (straight + ends);
  CHECK(paper_probe_force(ground.view, capsule, stiffness).force.z() ==
        Approx(stiffness * mean).epsilon(0.02));
}

TEST_CASE("The means are over the map's own samples where these are neither too many nor too few") {
  const Ground ground;
  const PaperProbeForce found =
      paper_probe_force(ground.view, SphereProbe({0, 0, 0}, 0.0035), stiffness);
  CHECK(found.far_count ==
        Approx(std::numbers::pi * 0.0035 * 0.0035 / (2.5e-4 * 2.5e-4)).epsilon(0.02));
}

TEST_CASE("On a ball-shaped object a ball feels the integrals over the exact surfaces") {
  constexpr double large = 0.02, small = 0.004;
  const Ground ground([](double x, double y) {
    const double square = large * large - x * x - y * y;
    return square > 0 ? 0.01 + large - std::sqrt(square) : std::numeric_limits<double>::infinity();
  });
  // As deep as the ball's radius, less, and only its lower side; beside the middle, so that the
  // normals do not cancel.
  for (const double depth : {0.0045, 0.002, -0.001}) {
    const Vector3 centre(0.003, -0.002, -depth);
    Vector3 skin = Vector3::Zero(), body = Vector3::Zero();
    double count = 0, length = 0;
    constexpr int fine = 1500;
    for (int i = 0; i < fine; ++i) {
      for (int j = 0; j < fine; ++j) {
        const double x = ((i + 0.5) * 2 / fine - 1) * small, y = ((j + 0.5) * 2 / fine - 1) * small;
        const double square = small * small - x * x - y * y;
        if (square < 0) continue;
        const Vector3 over = centre + Vector3(x, y, 0);
        const double half = std::sqrt(square);
        const double top = std::sqrt(large * large - over.x() * over.x() - over.y() * over.y());
        const Vector3 normal = Vector3(over.x(), over.y(), top) / top;  // n_S of eq. 5
        const double middle = top - large - over.z();
        const double far = middle + half, near = middle - half;
        skin += (std::max(far, 0.0) + std::max(near, 0.0)) * normal;
        count += (far > 0 ? 1 : 0) + (near > 0 ? 1 : 0);
        const double from = std::max(near, 0.0), to = std::max(far, 0.0);
        body += (to * to - from * from) / 2 * normal;
        length += to - from;
      }
    }
    const SphereProbe probe(centre, small);
    const Vector3 wanted = stiffness * skin / count;
    // Slopes are differences between samples, whose middle is half a sample beside the place.
    CHECK((paper_probe_force(ground.view, probe, stiffness).force - wanted).norm() <
          0.02 * wanted.norm());
    const Vector3 wanted_body = stiffness * body / length;
    CHECK((paper_probe_volume_force(ground.view, probe, stiffness) - wanted_body).norm() <
          0.02 * wanted_body.norm());
  }
}

TEST_CASE("On a slope the force is along the surface's normal, not the plane's") {
  const Ground ground(0.5);
  const Vector3 force =
      paper_probe_force(ground.view, SphereProbe({0, 0, -0.002}, 0.004), stiffness).force;
  const Vector3 normal = surface_normal(ground.plane(), 0.5, 0);
  CHECK(force.normalized().dot(normal.normalized()) == Approx(1));
}

TEST_CASE("On a slope of 30 degrees eq. 10 gives 15 % more than along a unit normal") {
  const double slope = std::tan(std::numbers::pi / 6);
  const Ground ground(slope);
  // Wholly in the ground, where the mean depth along the plane's normal is that of the centre.
  const PaperProbeForce found =
      paper_probe_force(ground.view, SphereProbe({0, 0, -0.015}, 0.004), stiffness);
  CHECK(found.near_count == found.far_count);
  CHECK(found.force.norm() ==
        Approx(stiffness * 0.015 / std::cos(std::numbers::pi / 6)).epsilon(0.001));
}

TEST_CASE("A ball far smaller than a map's samples feels what it would on any map") {
  const Ground ground;  // samples every 0.25 mm
  for (const double small : {1e-6, 2e-5, 1e-4, 2e-4}) {
    for (const double at : {0.0, 1.1e-4, 1.25e-4}) {
      const SphereProbe probe({at, -at, 0}, small);
      INFO(small << " at " << at);
      // The mean over some 256 places is off by a per cent or two.
      CHECK(paper_probe_force(ground.view, probe, stiffness).force.z() ==
            Approx(stiffness * 2 * small / 3).epsilon(0.02));
      CHECK(paper_probe_volume_force(ground.view, probe, stiffness).z() ==
            Approx(stiffness * 3 * small / 8).epsilon(0.02));
    }
  }
}

TEST_CASE("A ball that covers more samples than a tick has time for feels the same to 1 %") {
  const Ground ground;  // 241 x 241 samples
  for (const double at : {0.0, 1.1e-4, 7e-4}) {
    const SphereProbe probe({at, -at, 0}, 0.028);
    const PaperProbeForce found = paper_probe_force(ground.view, probe, stiffness);
    CHECK(found.far_count < 1.1 * most_probe_samples);
    CHECK(found.force.z() == Approx(stiffness * 2 * 0.028 / 3).epsilon(0.01));
  }
}

TEST_CASE("Over the ground, beside the map or nowhere a probe feels nothing") {
  const Ground ground;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector3& centre :
       {Vector3(0, 0, 0.0101), Vector3(1, 0, -0.01), Vector3(nan, 0, 0), Vector3(0, 0, nan)}) {
    const SphereProbe probe(centre, radius);
    CHECK(paper_probe_force(ground.view, probe, stiffness).force.isZero());
    CHECK(paper_probe_volume_force(ground.view, probe, stiffness).isZero());
  }
  CHECK(paper_probe_force(AssetView{}, SphereProbe({0, 0, 0}, radius), stiffness).far_count == 0);
}

}  // namespace
}  // namespace spm::paper_probe_force_test
