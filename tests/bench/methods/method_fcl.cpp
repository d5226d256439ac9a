// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/bench/geometry/sided_mesh.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/methods/probe_method.hpp"

namespace spm::bench {
namespace {

using FclMesh = fcl::BVHModel<fcl::OBBRSSd>;

constexpr double point_radius = 1e-9;  // m: FCL has no points; a ball below rounding size

void build(FclMesh& tree, const FloatMesh& mesh) {
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (const auto& vertex : mesh.vertices) vertices.emplace_back(vertex[0], vertex[1], vertex[2]);
  for (const auto& triangle : mesh.triangles) {
    triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
  }
  tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  tree.addSubModel(vertices, triangles);
  tree.endModel();
}

/// FCL's search, begun at the distance of the triangle that was nearest before, or at the band's
/// reach where that is less.
class Fcl : public Method {
 public:
  explicit Fcl(const Model& model)
      : mesh_(model),
        slack_(1e-7 * model.mesh.diagonal + point_radius),
        reach_(std::max(model.band.max_depth, model.band.margin) + slack_) {
    const Clock::time_point start = Clock::now();
    build(tree_, mesh_.mesh());
    facts_.name = "fcl";
    facts_.settings = "OBBRSS";
    facts_.file_bytes = mesh_.mesh().bytes();
    facts_.resident_bytes =
        static_cast<std::uint64_t>(tree_.getNumBVs()) * sizeof(fcl::BVNode<fcl::OBBRSSd>) +
        mesh_.mesh().vertices.size() * sizeof(fcl::Vector3d) +
        mesh_.mesh().triangles.size() * sizeof(fcl::Triangle) + mesh_.bytes();
    facts_.open_seconds = mesh_.seconds() + seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    place_.translation() = point;
    const fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    const double before = mesh_.distance(point, last_);
    result.min_distance = std::min(before + slack_, reach_);
    fcl::distance(&tree_, fcl::Transform3d::Identity(), &ball_, place_, request, result);
    if (result.b1 < 0 && before > reach_) return far_answer();
    // FCL names nothing where it finds nothing nearer than it was told.
    if (result.b1 >= 0) last_ = static_cast<std::uint32_t>(result.b1);
    return mesh_.answer(point, last_);
  }

 private:
  SidedMesh mesh_;
  double slack_;  ///< m: so that rounding loses no triangle
  double reach_;  ///< m: of the band
  FclMesh tree_;
  fcl::Sphered ball_{point_radius};
  mutable fcl::Transform3d place_ = fcl::Transform3d::Identity();
  mutable std::uint32_t last_ = 0;  ///< the nearest triangle before
};

class FclProbe final : public ProbeMethod {
 public:
  FclProbe(const Model& model, double radius)
      : ProbeMethod("fcl", "OBBRSS, collide, 64 contacts"), ball_(radius) {
    build(tree_, FloatMesh(model.surface));
  }

  [[nodiscard]] double depth(const Vector3& centre) override {
    fcl::Transform3d place = fcl::Transform3d::Identity();
    place.translation() = centre;
    const fcl::CollisionRequestd request(64, true);
    fcl::CollisionResultd result;
    fcl::collide(&tree_, fcl::Transform3d::Identity(), &ball_, place, request, result);
    double deepest = 0;
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      // A ball's depth in a triangle comes out negative in FCL 0.7.
      deepest = std::max(deepest, std::abs(result.getContact(i).penetration_depth));
    }
    return deepest;
  }

 private:
  FclMesh tree_;
  fcl::Sphered ball_;
};

}  // namespace

std::unique_ptr<Method> make_fcl(const Model& model) { return std::make_unique<Fcl>(model); }

std::unique_ptr<ProbeMethod> make_fcl_probe(const Model& model, double radius) {
  return std::make_unique<FclProbe>(model, radius);
}

}  // namespace spm::bench
