// SPDX-License-Identifier: GPL-3.0-or-later
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "tests/bench/geometry/sided_mesh.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/methods/probe_method.hpp"

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

  [[nodiscard]] btBvhTriangleMeshShape& shape() noexcept { return shape_; }
  [[nodiscard]] const btBvhTriangleMeshShape& shape() const noexcept { return shape_; }

 private:
  FloatMesh mesh_;
  btTriangleIndexVertexArray arrays_;
  btBvhTriangleMeshShape shape_;
};

/// The nearest of the triangles that Bullet finds in a box, by Bullet's own arithmetic.
class ShowTriangles final : public btTriangleCallback {
 public:
  explicit ShowTriangles(const btVector3& point) : point_(point) {}
  void processTriangle(btVector3* corners, int, int index) override {
    const float squared = squared_distance(corners[0], corners[1], corners[2]);
    if (!(squared < nearest_squared)) return;
    nearest_squared = squared;
    nearest = static_cast<std::uint32_t>(index);
  }

 private:
  /// As btVoronoiSimplexSolver::closestPtPointTriangle, which is not open to callers.
  [[nodiscard]] float squared_distance(const btVector3& a, const btVector3& b,
                                       const btVector3& c) const {
    const btVector3 ab = b - a, ac = c - a, ap = point_ - a;
    const float d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return ap.length2();
    const btVector3 bp = point_ - b;
    const float d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return bp.length2();
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return (ap - d1 / (d1 - d3) * ab).length2();
    const btVector3 cp = point_ - c;
    const float d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return cp.length2();
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return (ap - d2 / (d2 - d6) * ac).length2();
    const float va = d3 * d6 - d5 * d4, to_c = d4 - d3, to_b = d5 - d6;
    if (va <= 0 && to_c >= 0 && to_b >= 0 && to_c + to_b > 0) {
      return (bp - to_c / (to_c + to_b) * (c - b)).length2();
    }
    const float scale = 1 / (va + vb + vc);
    return (ap - vb * scale * ab - vc * scale * ac).length2();
  }

  btVector3 point_;

 public:
  float nearest_squared = std::numeric_limits<float>::infinity();
  std::uint32_t nearest = 0;
};

/// Bullet's boxes, asked in a box that holds the triangle that was nearest before, or where that is
/// beyond the band in boxes that grow.
class Bullet : public Method {
 public:
  explicit Bullet(const Model& model)
      : sided_(model),
        start_(Clock::now()),
        mesh_(sided_.mesh()),
        slack_(1e-6 * model.mesh.diagonal),
        reach_(std::max(model.band.max_depth, model.band.margin) + slack_) {
    facts_.name = "bullet";
    facts_.settings = "btBvhTriangleMeshShape";
    facts_.file_bytes = sided_.mesh().bytes();
    facts_.resident_bytes =
        mesh_.shape().getOptimizedBvh()->calculateSerializeBufferSize() + sided_.bytes();
    facts_.open_seconds = sided_.seconds() + seconds_since(start_);
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    if (!point.allFinite()) return far_answer();
    const double before = sided_.distance(point, last_) + slack_;
    // Boxes hold more triangles than balls. So try small boxes first, as an expert user would.
    for (double reach = before <= reach_ ? before : first_reach;;
         reach = std::min(2 * reach, reach_)) {
      ShowTriangles show(bullet_vector(point));
      const Vector3 corner = Vector3::Constant(reach);
      mesh_.shape().processAllTriangles(&show, bullet_vector(point - corner),
                                        bullet_vector(point + corner));
      const bool found = show.nearest_squared <= reach * reach;
      if (!found && reach < reach_) continue;
      if (!found) return far_answer();
      last_ = show.nearest;
      return sided_.answer(point, last_);
    }
  }

 private:
  SidedMesh sided_;
  Clock::time_point start_;
  BulletMesh mesh_;
  double slack_;                    ///< m: so that rounding loses no triangle
  double reach_;                    ///< m: of the band
  mutable std::uint32_t last_ = 0;  ///< the nearest triangle before
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
