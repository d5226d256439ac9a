// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "common/query/query.hpp"
#include "tests/bench/sixdof/sixdof_peers.hpp"

namespace spm::bench {
namespace {

class EverySample : public Peer {
 public:
  EverySample(const SurfaceSamples& tool, const AssetView& object, double stiffness)
      : tool_(tool), object_(object), stiffness_(stiffness) {}

  [[nodiscard]] PeerAnswer ask(const Eigen::Isometry3d& tool_pose) override {
    return press_every_sample(tool_, object_, tool_pose, stiffness_);
  }
  [[nodiscard]] std::string name() const override { return "every-sample"; }
  [[nodiscard]] std::string settings() const override {
    return fmt::format("{} samples", samples());
  }
  [[nodiscard]] std::uint64_t samples() const override { return tool_.levels.back().count; }
  [[nodiscard]] bool same_law() const override { return true; }

 private:
  const SurfaceSamples& tool_;
  const AssetView& object_;
  double stiffness_;
};

}  // namespace

PeerAnswer press_every_sample(const SurfaceSamples& tool, const AssetView& object,
                              const Eigen::Isometry3d& tool_pose, double stiffness) {
  PeerAnswer answer;
  answer.torque = Vector3::Zero();
  const SampleLevel& finest = tool.levels.back();
  for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
    const auto& position = tool.places[i].position;
    const Vector3 place = tool_pose * Vector3(position[0], position[1], position[2]);
    const Answer found = query_point(object, place);
    if (!(found.distance < 0)) continue;
    const Vector3 force =
        -stiffness * static_cast<double>(tool.shares[i].area) * found.distance * found.normal;
    answer.force += force;
    *answer.torque += (place - tool_pose.translation()).cross(force);
    ++answer.contacts;
  }
  return answer;
}

std::unique_ptr<Peer> make_every_sample(const SurfaceSamples& tool, const AssetView& object,
                                        double stiffness) {
  return std::make_unique<EverySample>(tool, object, stiffness);
}

}  // namespace spm::bench
