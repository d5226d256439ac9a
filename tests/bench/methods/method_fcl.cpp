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

#include "tests/bench/geometry/triangle_neighbours.hpp"
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

class Fcl : public Method {
 public:
  explicit Fcl(const Model& model)
      : mesh_(model.surface), neighbours_(mesh_), tie_(1e-7 * model.mesh.diagonal) {
    const Clock::time_point start = Clock::now();
    build(tree_, mesh_);
    facts_.name = "fcl";
    facts_.settings = "OBBRSS";
    facts_.bytes =
        static_cast<std::uint64_t>(tree_.getNumBVs()) * sizeof(fcl::BVNode<fcl::OBBRSSd>) +
        mesh_.vertices.size() * sizeof(fcl::Vector3d) +
        mesh_.triangles.size() * sizeof(fcl::Triangle) + mesh_.bytes() + neighbours_.bytes();
    facts_.build_seconds = seconds_since(start);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    const fcl::Sphered ball(point_radius);
    fcl::Transform3d place = fcl::Transform3d::Identity();
    place.translation() = point;
    const fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    fcl::distance(&tree_, fcl::Transform3d::Identity(), &ball, place, request, result);
    if (result.b1 < 0) return far_answer();
    return neighbours_.answer(mesh_, point, static_cast<std::uint32_t>(result.b1), tie_);
  }

 private:
  FloatMesh mesh_;
  TriangleNeighbours neighbours_;
  double tie_;
  FclMesh tree_;
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
