// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcl/fcl.h>
#include <fmt/format.h>

#include "tests/bench/sixdof/sixdof_peers.hpp"

namespace spm::bench {
namespace {

constexpr std::size_t max_contacts = 100000;

using Tree = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Tree> tree_of(const baker::OuterSurface& surface) {
  auto tree = std::make_shared<Tree>();
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i < surface.solid_count; ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    triangles.emplace_back(a, b, c);
  }
  tree->beginModel(static_cast<int>(triangles.size()), static_cast<int>(surface.vertices.size()));
  tree->addSubModel(surface.vertices, triangles);
  tree->endModel();
  return tree;
}

class Fcl : public Peer {
 public:
  Fcl(const BakedObject& tool, const BakedObject& object)
      : tool_(tree_of(tool.surface)), object_(tree_of(object.surface)) {}

  [[nodiscard]] PeerAnswer ask(const Eigen::Isometry3d& tool_pose) override {
    const fcl::CollisionRequestd request(max_contacts, true);
    fcl::CollisionResultd result;
    fcl::collide(object_.get(), Eigen::Isometry3d::Identity(), tool_.get(), tool_pose, request,
                 result);
    PeerAnswer answer;
    answer.contacts = result.numContacts();
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const fcl::Contactd& contact = result.getContact(i);
      // Its normals point from the first object to the second.
      answer.force += contact.penetration_depth * contact.normal;
    }
    return answer;
  }
  [[nodiscard]] std::string name() const override { return "fcl"; }
  [[nodiscard]] std::string settings() const override { return "OBB-RSS, all contacts"; }

 private:
  std::shared_ptr<Tree> tool_, object_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl(const BakedObject& tool, const BakedObject& object) {
  return std::make_unique<Fcl>(tool, object);
}

}  // namespace spm::bench
