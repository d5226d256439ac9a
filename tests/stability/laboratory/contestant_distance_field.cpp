// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

class DistanceField final : public Contestant {
 public:
  DistanceField(const bench::Method& field, double radius, double stiffness)
      : field_(field), radius_(radius), stiffness_(stiffness) {}

  void begin(const Vector3&) override {}

  ContactForce next(const Vector3& measured, const Vector3& moved) override {
    const Answer answer = field_.query(measured - moved);
    ContactForce contact;
    // Written so that a point without a distance counts as no contact.
    if (!(answer.distance < radius_)) return contact;
    contact.contact = true;
    contact.depth = radius_ - answer.distance;
    contact.normal = answer.normal;
    contact.force = stiffness_ * contact.depth * answer.normal;
    return contact;
  }

 private:
  const bench::Method& field_;
  double radius_, stiffness_;
};

}  // namespace

std::unique_ptr<Contestant> distance_field_contestant(const PreparedObject& object,
                                                      double probe_radius, double stiffness) {
  return std::make_unique<DistanceField>(object.distance_field(), probe_radius, stiffness);
}

}  // namespace spm::stability
