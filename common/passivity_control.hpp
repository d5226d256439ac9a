// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "common/vector.hpp"

namespace spm {

/// Longest delay that is reckoned with, ticks.
inline constexpr double most_delay_ticks = 8;

struct PassivitySettings {
  double delay_ticks = 1;    ///< between a reading and the force that answers it, 0 or more
  double tick = 1e-3;        ///< s, above 0
  double encoder_step = 0;   ///< m, 0 or more
  double device_mass = 0.1;  ///< kg, above 0
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
class PassivityControl {
 public:
  explicit PassivityControl(const PassivitySettings& settings) noexcept;

  /// One tick in contact: the force to send, N, for what is wanted, N. `hand` in m, `velocity` in
  /// m/s; `stiffness` in N/m of what touches; `stored`: J, in its springs; `carried`: J, that
  /// objects which moved did on the hand since the last tick: no fault of the loop's.
  [[nodiscard]] Vector3 next(const Vector3& wanted, const Vector3& hand, const Vector3& velocity,
                             double stiffness, double stored, double carried) noexcept;

  /// One tick without contact.
  void rest() noexcept;

  /// Forgets all.
  void reset() noexcept;

  /// J that were generated and not taken back yet; below 0: dissipated.
  [[nodiscard]] double generated() const noexcept { return generated_; }
  /// N s/m.
  [[nodiscard]] double most_damping() const noexcept { return most_damping_; }

 private:
  /// What was sent in a tick: force in N, and what its damping is to take, J.
  struct Sent {
    Vector3 force = Vector3::Zero();
    double taken = 0;
  };
  static constexpr std::size_t kept = 16;  ///< ticks; more than the longest delay

  [[nodiscard]] const Sent& ago(std::size_t ticks) const noexcept {
    return sent_[(newest_ + kept - ticks) % kept];
  }
  void observe(const Vector3& moved, double stiffness, double stored, double carried) noexcept;
  void send(const Sent& sent) noexcept;

  double tick_, encoder_step_, most_damping_;
  std::size_t whole_delay_;        ///< ticks
  double part_delay_;              ///< and so much of one, 0 to 1
  std::array<Sent, kept> sent_{};  ///< a ring
  std::size_t newest_ = 0;
  Vector3 hand_ = Vector3::Zero();
  double stored_ = 0, generated_ = 0;
  bool touching_ = false;
  bool came_free_ = false;  ///< there was no contact in the tick before
};

}  // namespace spm
