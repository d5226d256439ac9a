// SPDX-License-Identifier: GPL-3.0-or-later
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cstdint>

#include "common/surface/closest_on_triangle.hpp"
#include "tests/bench/geometry/nearest_point.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/methods/probe_method.hpp"
#include "tests/bench/model/float_mesh.hpp"

namespace spm::bench {
namespace {

constexpr double first_reach = 0.25e-3;  // m

btVector3 bullet_vector(const Vector3& vector) {
  return {static_cast<btScalar>(vector.x()), static_cast<btScalar>(vector.y()),
          static_cast<btScalar>(vector.z())};
}

/// The mesh as Bullet uses it: Bullet reads our vertices and triangles in place.
class BulletMesh {
 public:
  explicit BulletMesh(FloatMesh mesh)
      : mesh_(std::move(mesh)),
        arrays_(static_cast<int>(mesh_.triangles.size()),
                reinterpret_cast<int*>(mesh_.triangles.data()), 3 * sizeof(std::uint32_t),
                static_cast<int>(mesh_.vertices.size()), mesh_.vertices.data()->data(),
                3 * sizeof(float)),
        shape_(&arrays_, true) {
    static_assert(sizeof(btScalar) == sizeof(float));
    shape_.setMargin(0);
  }

  [[nodiscard]] const FloatMesh& mesh() const noexcept { return mesh_; }
  [[nodiscard]] btBvhTriangleMeshShape& shape() noexcept { return shape_; }
  [[nodiscard]] const btBvhTriangleMeshShape& shape() const noexcept { return shape_; }

 private:
  FloatMesh mesh_;
  btTriangleIndexVertexArray arrays_;
  btBvhTriangleMeshShape shape_;
};

Vector3 vector_of(const btVector3& vector) noexcept {
  return {static_cast<double>(vector.x()), static_cast<double>(vector.y()),
          static_cast<double>(vector.z())};
}

/// Shows each triangle that Bullet finds in a box.
class ShowTriangles final : public btTriangleCallback {
 public:
  ShowTriangles(const Vector3& point, double tie) : point_(point), nearest(point, tie) {}
  void processTriangle(btVector3* corners, int, int) override {
    const Vector3 a = vector_of(corners[0]), b = vector_of(corners[1]), c = vector_of(corners[2]);
    nearest.show(closest_on_triangle(point_, a, b, c), a, b, c);
  }

 private:
  Vector3 point_;

 public:
  NearestPoint nearest;
};

class Bullet : public Method {
 public:
  explicit Bullet(const Model& model)
      : start_(Clock::now()),
        mesh_(FloatMesh(model.surface)),
        reach_(std::max(model.band.max_depth, model.band.margin)),
        tie_(1e-7 * model.mesh.diagonal) {
    facts_.name = "bullet";
    facts_.settings = "btBvhTriangleMeshShape";
    facts_.bytes =
        mesh_.shape().getOptimizedBvh()->calculateSerializeBufferSize() + mesh_.mesh().bytes();
    facts_.build_seconds = seconds_since(start_);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    // Boxes hold more triangles than balls. So try small boxes first, as an expert user would.
    for (double reach = first_reach;; reach = std::min(2 * reach, reach_)) {
      ShowTriangles show(point, tie_);
      const Vector3 corner = Vector3::Constant(reach + tie_);
      mesh_.shape().processAllTriangles(&show, bullet_vector(point - corner),
                                        bullet_vector(point + corner));
      if (show.nearest.distance() <= reach || reach >= reach_) return show.nearest.answer();
    }
  }

 private:
  Clock::time_point start_;
  BulletMesh mesh_;
  double reach_;
  double tie_;
};

/// The deepest contact of a pair.
class DeepestContact final : public btCollisionWorld::ContactResultCallback {
 public:
  btScalar addSingleResult(btManifoldPoint& contact, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    depth = std::max(depth, -static_cast<double>(contact.getDistance()));
    return 0;
  }
  double depth = 0;
};

class BulletProbe final : public ProbeMethod {
 public:
  BulletProbe(const Model& model, double radius)
      : ProbeMethod("bullet", "contactPairTest, in mm"),
        mesh_(in_millimetres(FloatMesh(model.surface))),
        ball_(static_cast<btScalar>(1e3 * radius)) {
    mesh_object_.setCollisionShape(&mesh_.shape());
    ball_object_.setCollisionShape(&ball_);
  }

  [[nodiscard]] double depth(const Vector3& centre) override {
    ball_object_.getWorldTransform().setOrigin(bullet_vector(1e3 * centre));
    DeepestContact deepest;
    world_.contactPairTest(&ball_object_, &mesh_object_, deepest);
    return deepest.depth / 1e3;
  }

 private:
  /// Bullet's own margins and thresholds are meant for objects of about this many units.
  static FloatMesh in_millimetres(FloatMesh mesh) {
    for (auto& vertex : mesh.vertices) {
      for (float& coordinate : vertex) coordinate *= 1e3F;
    }
    return mesh;
  }

  BulletMesh mesh_;
  btSphereShape ball_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_{&dispatcher_, &broadphase_, &configuration_};
  btCollisionObject mesh_object_;
  btCollisionObject ball_object_;
};

}  // namespace

std::unique_ptr<Method> make_bullet(const Model& model) { return std::make_unique<Bullet>(model); }

std::unique_ptr<ProbeMethod> make_bullet_probe(const Model& model, double radius) {
  return std::make_unique<BulletProbe>(model, radius);
}

}  // namespace spm::bench
