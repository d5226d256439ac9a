// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/mesh_proxy.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

class MeshGodObject final : public Contestant {
 public:
  MeshGodObject(const bench::FloatMesh& mesh, double radius, double stiffness)
      : proxy_(bench::make_mesh_proxy(mesh, {true, false, radius, stiffness})) {}

  void begin(const Vector3& start) override {
    held_ = start;
    moved_.setZero();
    proxy_->place(start);
  }

  ContactForce next(const Vector3& measured, const Vector3& moved) override {
    // The object moved under the proxy, which stays where it is in the world.
    if (moved != moved_) proxy_->place(held_ - moved);
    moved_ = moved;
    const bench::ProxyContact found = proxy_->follow(measured - moved);
    held_ = found.proxy + moved;
    ContactForce contact;
    contact.contact = found.contact;
    if (!found.contact) return contact;
    contact.force = found.force;
    contact.normal = found.normal;
    contact.depth = found.depth;
    return contact;
  }

 private:
  std::unique_ptr<bench::MeshProxy> proxy_;
  Vector3 held_ = Vector3::Zero();   ///< m, world: where the proxy is
  Vector3 moved_ = Vector3::Zero();  ///< m, of the object
};

}  // namespace

std::unique_ptr<Contestant> mesh_proxy_contestant(const PreparedObject& object, double probe_radius,
                                                  double stiffness) {
  return std::make_unique<MeshGodObject>(object.float_mesh(), probe_radius, stiffness);
}

}  // namespace spm::stability
