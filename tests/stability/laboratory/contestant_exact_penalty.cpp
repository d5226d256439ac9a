// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/reports/force_errors.hpp"
#include "tests/stability/laboratory/contestants.hpp"

namespace spm::stability {
namespace {

class ExactPenalty final : public Contestant {
 public:
  ExactPenalty(const bench::Model& model, double radius, double stiffness)
      : surface_(model.truth), radius_(radius), stiffness_(stiffness) {
    is_closed_ = model.mesh.closed();
    const Vector3 reach = Vector3::Constant(radius);
    low_ = model.mesh.box_min - reach;
    high_ = model.mesh.box_max + reach;
  }

  void begin(const Vector3&) override { same_within_ = 0; }

  ContactForce next(const Vector3& measured, const Vector3& moved) override {
    ContactForce contact;
    const Vector3 point = measured - moved;
    if ((point.array() < low_.array()).any() || (point.array() > high_.array()).any()) {
      return contact;
    }
    const baker::SurfacePoint closest_point = surface_.closest(point);
    const Vector3 away = point - closest_point.position;
    const double distance = away.norm();
    look(point, distance);
    bench::ExactTick tick;
    tick.distance = inside_ ? -distance : distance;
    // On the surface itself, the vector to the surface has no direction.
    tick.outward = distance > 0 ? Vector3(away / tick.distance) : closest_point.normal;
    contact.force = bench::exact_penalty(tick, stiffness_, radius_);
    contact.contact = tick.distance < radius_;
    if (!contact.contact) return contact;
    contact.depth = radius_ - tick.distance;
    contact.normal = tick.outward;
    return contact;
  }

 private:
  /// Which side of a closed surface a point is on: the same as before, unless the surface may lie
  /// between.
  void look(const Vector3& point, double distance) {
    const bool is_same = (point - looked_).norm() < same_within_;
    if (!is_same) inside_ = surface_.inside(point);
    looked_ = point;
    // Rounding aside.
    same_within_ = is_closed_ ? 0.999 * distance : 0;
  }

  const baker::ExactSurface& surface_;
  double radius_, stiffness_;
  Vector3 low_, high_;  ///< m, beyond which there is no contact
  bool is_closed_ = false;
  // State of the last point looked at, in the object's frame, m.
  Vector3 looked_ = Vector3::Zero();
  double same_within_ = 0;
  bool inside_ = false;
};

}  // namespace

std::unique_ptr<Contestant> exact_penalty_contestant(const PreparedObject& object,
                                                     double probe_radius, double stiffness) {
  return std::make_unique<ExactPenalty>(object.model(), probe_radius, stiffness);
}

}  // namespace spm::stability
