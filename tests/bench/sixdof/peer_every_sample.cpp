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
    PeerAnswer answer;
    const SampleLevel& finest = tool_.levels.back();
    for (std::uint32_t i = finest.first; i < finest.first + finest.count; ++i) {
      const auto& position = tool_.places[i].position;
      const Answer found =
          query_point(object_, tool_pose * Vector3(position[0], position[1], position[2]));
      if (!(found.distance < 0)) continue;
      answer.force -=
          stiffness_ * static_cast<double>(tool_.shares[i].area) * found.distance * found.normal;
      ++answer.contacts;
    }
    return answer;
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

std::unique_ptr<Peer> make_every_sample(const SurfaceSamples& tool, const AssetView& object,
                                        double stiffness) {
  return std::make_unique<EverySample>(tool, object, stiffness);
}

}  // namespace spm::bench
