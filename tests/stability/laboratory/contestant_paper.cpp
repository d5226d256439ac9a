// SPDX-License-Identifier: GPL-3.0-or-later
#include "common/paper/implicit_probe.hpp"
#include "common/paper/paper_probe_force.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

/// A ball by eq. 10 and 11, on a scalar map; without memory.
class PaperBall final : public Contestant {
 public:
  PaperBall(const AssetView& asset, double radius, double stiffness)
      : asset_(asset), radius_(radius), stiffness_(stiffness) {}

  void begin(const Vector3&) override {}

  ContactForce next(const Vector3& measured, const Vector3& moved) override {
    const PaperProbeForce found =
        paper_probe_force(asset_, SphereProbe(measured - moved, radius_), stiffness_);
    ContactForce contact;
    contact.force = found.force;
    contact.contact = found.far_count + found.near_count > 0;
    const double size = found.force.norm();
    if (size > 0) contact.normal = found.force / size;
    contact.depth = size / stiffness_;
    return contact;
  }

 private:
  const AssetView& asset_;
  double radius_, stiffness_;
};

}  // namespace

std::unique_ptr<Contestant> paper_contestant(const PreparedObject& object,
                                             const StabilityCase& tried,
                                             const RunSettings& settings) {
  if (tried.probe_radius > 0) {
    return std::make_unique<PaperBall>(object.paper(), tried.probe_radius, settings.stiffness);
  }
  return product_contestant({"paper", {}}, object, tried, settings);
}

}  // namespace spm::stability
