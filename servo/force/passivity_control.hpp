// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "common/contact/stabilization_settings.hpp"
#include "common/base/vector.hpp"

namespace spm {

struct PassivitySettings {
  double delay_ticks = 1;    ///< between a reading and the force that answers it, 0 or more
  double tick = 1e-3;        ///< s, above 0
  double encoder_step = 0;   ///< m, 0 or more
  double device_mass = 0.1;  ///< kg, above 0
  /// The same of a turn, used with six components alone: as a length and a mass at the lever by
  /// which turns and torques are made lengths and forces.
  double turn_step = 0;          ///< m, rad times the lever; 0 or more
  double turning_inertia = 0.1;  ///< kg, kg m2 over the lever squared; above 0
};

/// What is dissipated beyond need counts against what is generated later up to this, J: a hand that
/// slid for a while over something rough has no leave to be shaken by it afterwards.
inline constexpr double most_credit = 2e-5;

/// What was generated is taken back over about so many ticks: at once it would be felt as knocks,
/// since an encoder tells motion and energy by steps.
inline constexpr double spread_ticks = 4;

/// Time-domain passivity observer and controller (Hannaford and Ryu 2002): keeps account of the
/// energy that a contact has given the hand, and takes what is too much by damping. The account is
/// the work of the forces that were sent, each from when it acts on, and what the contact's springs
/// hold now: so that what the sampling makes is seen while a spring is pressed, and not when it has
/// thrown the hand out. It begins anew with each contact. The damping is at most
/// min(0.25 m / T, 0.1 N T / D): more of it shakes a hand at rest by single encoder steps.
///
/// With three components force and place are a point's. With six they are force and torque, place
/// and turn, the latter at one lever: N of N m and m of rad. There is one account of both, for
/// contacts away from the middle pass energy from the place to the turn and back; damping acts on
/// both, each up to its own most.
template <int components>
class PassivityControlOf {
 public:
  static_assert(components == 3 || components == 6);
  using Vector = Eigen::Matrix<double, components, 1>;

  explicit PassivityControlOf(const PassivitySettings& settings) noexcept;

  /// One tick in contact: the force to send, N, for what is wanted, N. `hand` in m, whose change
  /// is the motion that the force works along; `velocity` in m/s; `stiffness` in N/m of what
  /// touches; `stored`: J, in its springs; `carried`: J, that objects which moved did on the hand
  /// since the last tick: no fault of the loop's.
  [[nodiscard]] Vector next(const Vector& wanted, const Vector& hand, const Vector& velocity,
                            double stiffness, double stored, double carried) noexcept;

  /// One tick without contact.
  void rest() noexcept;

  /// Forgets all.
  void reset() noexcept;

  /// J that were generated and not taken back yet; below 0: dissipated.
  [[nodiscard]] double generated() const noexcept { return generated_; }
  /// N s/m; of the turn with part 1.
  [[nodiscard]] double most_damping(std::size_t part = 0) const noexcept {
    return most_damping_[part];
  }

 private:
  static constexpr std::size_t parts = components / 3;  ///< the place, and the turn
  /// What was sent in a tick: force in N, and what its damping is to take, J.
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
  std::array<double, parts> encoder_step_, most_damping_;
  std::size_t whole_delay_;        ///< ticks
  double part_delay_;              ///< and so much of one, 0 to 1
  std::array<Sent, kept> sent_{};  ///< a ring
  std::size_t newest_ = 0;
  Vector hand_ = Vector::Zero();
  double stored_ = 0, generated_ = 0;
  bool touching_ = false;
  bool came_free_ = false;  ///< there was no contact in the tick before
};

using PassivityControl = PassivityControlOf<3>;
/// Of a tool that turns.
using WrenchPassivityControl = PassivityControlOf<6>;

extern template class PassivityControlOf<3>;
extern template class PassivityControlOf<6>;

}  // namespace spm
