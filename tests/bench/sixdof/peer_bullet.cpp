// SPDX-License-Identifier: GPL-3.0-or-later
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>

#include "tests/bench/sixdof/sixdof_peers.hpp"

namespace spm::bench {
namespace {

/// Bullet's tolerances are meant for metres; the scene is handed on in millimetres.
constexpr double unit = 1e3;

btVector3 to_bullet(const Vector3& v) {
  return {static_cast<btScalar>(v.x() * unit), static_cast<btScalar>(v.y() * unit),
          static_cast<btScalar>(v.z() * unit)};
}

/// A mesh as Bullet holds it.
class Body {
 public:
  explicit Body(const baker::OuterSurface& surface) {
    for (std::size_t i = 0; i < surface.solid_count; ++i) {
      const auto& [a, b, c] = surface.triangles[i];
      mesh_.addTriangle(to_bullet(surface.vertices[a]), to_bullet(surface.vertices[b]),
                        to_bullet(surface.vertices[c]));
    }
    shape_ = std::make_unique<btGImpactMeshShape>(&mesh_);
    shape_->setMargin(0);
    shape_->updateBound();
    object_.setCollisionShape(shape_.get());
  }
  [[nodiscard]] btCollisionObject& object() { return object_; }
  void move(const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3f turn = pose.linear().cast<float>();
    const btMatrix3x3 basis(turn(0, 0), turn(0, 1), turn(0, 2), turn(1, 0), turn(1, 1), turn(1, 2),
                            turn(2, 0), turn(2, 1), turn(2, 2));
    object_.setWorldTransform(btTransform(basis, to_bullet(pose.translation())));
  }

 private:
  btTriangleMesh mesh_;
  std::unique_ptr<btGImpactMeshShape> shape_;
  btCollisionObject object_;
};

/// Adds up what Bullet reports.
struct Contacts : btCollisionWorld::ContactResultCallback {
  explicit Contacts(const btCollisionObject* tool) : tool_(tool) {}
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    // Its normals point from the second object to the first.
    const double side = first->getCollisionObject() == tool_ ? 1 : -1;
    const double depth = std::max(0.0, static_cast<double>(-point.getDistance()));
    const btVector3& normal = point.m_normalWorldOnB;
    answer.force += side * depth / unit * Vector3(normal.x(), normal.y(), normal.z());
    ++answer.contacts;
    return 0;
  }
  PeerAnswer answer;

 private:
  const btCollisionObject* tool_;
};

class Bullet : public Peer {
 public:
  Bullet(const BakedObject& tool, const BakedObject& object)
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &configuration_),
        tool_(tool.surface),
        object_(object.surface) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    // A test of a single pair uses another table, in which GImpact does not register itself.
    dispatcher_.registerClosestPointsCreateFunc(GIMPACT_SHAPE_PROXYTYPE, GIMPACT_SHAPE_PROXYTYPE,
                                                &create_);
  }
  [[nodiscard]] PeerAnswer ask(const Eigen::Isometry3d& tool_pose) override {
    tool_.move(tool_pose);
    Contacts contacts(&tool_.object());
    world_.contactPairTest(&tool_.object(), &object_.object(), contacts);
    return contacts.answer;
  }
  [[nodiscard]] std::string name() const override { return "bullet"; }
  [[nodiscard]] std::string settings() const override { return "GImpact, single precision"; }

 private:
  btGImpactCollisionAlgorithm::CreateFunc create_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_;
  Body tool_, object_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet(const BakedObject& tool, const BakedObject& object) {
  return std::make_unique<Bullet>(tool, object);
}

}  // namespace spm::bench
