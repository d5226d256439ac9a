// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "common/base/vector.hpp"
#include "common/contact/stabilization_settings.hpp"

namespace spm {

struct PassivitySettings {
  double delay_ticks = 1;    ///< between a reading and the force that answers it, 0 or more
  double tick = 1e-3;        ///< s, above 0
  double encoder_step = 0;   ///< m, 0 or more
  double device_mass = 0.1;  ///< kg, above 0
  /// The same for a rotation, used only with six components. Rotations and inertias are given as
  /// lengths and masses at the lever that converts rotations to lengths and torques to forces.
  double turn_step = 0;          ///< m, rad times the lever; 0 or more
  double turning_inertia = 0.1;  ///< kg, kg m2 over the lever squared; above 0
};

/// The limit of the credit, J. Energy that is dissipated beyond need counts against energy that is
/// generated later, up to this limit. Without it, a hand that slid over something rough for a while
/// could be shaken by it afterwards.
inline constexpr double max_credit = 2e-5;

/// Generated energy is taken back over about this many ticks. All at once it would be felt as
/// knocks, since an encoder reports motion and energy in steps.
inline constexpr double spread_ticks = 4;

/// Time-domain passivity observer and controller (Hannaford and Ryu 2002). It keeps an account of
/// the energy that a contact has given the hand, and takes the excess back by damping.
///
/// The account is the work of the forces that were sent, each from when it acts, plus the energy
/// that the contact's springs hold now. So an error of the sampling is seen while a spring is
/// pressed, not only when it has thrown the hand out. The account begins again with each contact.
/// The damping is at most min(0.25 m / T, 0.1 N T / D); a larger one shakes a hand at rest by
/// single encoder steps.
///
/// With three components, force and position are those of a point. With six they are force and
/// torque, position and rotation; the latter at one lever, which makes N of N m and m of rad. Both
/// share one account, because contacts away from the middle exchange energy between position and
/// rotation. Damping acts on both, each up to its own limit.
template <int components>
class PassivityControlOf {
 public:
  static_assert(components == 3 || components == 6);
  using Vector = Eigen::Matrix<double, components, 1>;

  explicit PassivityControlOf(const PassivitySettings& settings) noexcept;

  /// One tick in contact. Returns the force to send, N, for the force that is wanted, N. `hand` in
  /// m: the force works along its change. `velocity` in m/s. `stiffness` in N/m of what touches.
  /// `stored`: J, in the springs of the contact. `carried`: J, work on the hand since the last tick
  /// by objects that moved, which is no fault of the loop.
  [[nodiscard]] Vector next(const Vector& wanted, const Vector& hand, const Vector& velocity,
                            double stiffness, double stored, double carried) noexcept;

  /// Tells what was sent instead of the force that `next` returned, N: a soft start, a cap or a
  /// limit on growth may have taken from it.
  void sent(const Vector& force) noexcept;

  /// One tick without contact.
  void rest() noexcept;

  /// Forgets all.
  void reset() noexcept;

  /// Energy that was generated and not taken back yet, J; below 0: dissipated.
  [[nodiscard]] double generated() const noexcept { return generated_; }
  /// N s/m; part 1 is the rotation.
  [[nodiscard]] double max_damping(std::size_t part = 0) const noexcept {
    return max_damping_[part];
  }

 private:
  static constexpr std::size_t parts = components / 3;  ///< the position, and the rotation
  /// What was sent in a tick: the force in N, and the energy that its damping is to take, J.
  struct Sent {
    Vector force = Vector::Zero();
    double taken = 0;
  };
  static constexpr std::size_t kept = 16;  ///< ticks; more than the longest delay

  [[nodiscard]] const Sent& ago(std::size_t ticks) const noexcept {
    return sent_[(newest_ + kept - ticks) % kept];
  }
  void observe(const Vector& moved, double stiffness, double stored, double carried) noexcept;
  [[nodiscard]] static double within_step(const Vector3& moved, double step) noexcept;
  [[nodiscard]] Vector braking(const Vector& velocity, double power, double left) const noexcept;
  void send(const Sent& sent) noexcept;

  double tick_;
  std::array<double, parts> encoder_step_, max_damping_;
  std::size_t integer_delay_;      ///< ticks
  double fractional_delay_;        ///< the fraction of a tick beyond that, 0 to 1
  std::array<Sent, kept> sent_{};  ///< a ring buffer
  std::size_t newest_ = 0;
  Vector hand_ = Vector::Zero();
  double stored_ = 0, generated_ = 0;
  bool touching_ = false;
  bool came_free_ = false;  ///< there was no contact in the tick before
};

using PassivityControl = PassivityControlOf<3>;
/// For a tool that turns.
using WrenchPassivityControl = PassivityControlOf<6>;

extern template class PassivityControlOf<3>;
extern template class PassivityControlOf<6>;

}  // namespace spm
