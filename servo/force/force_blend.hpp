// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/hand_pose.hpp"
#include "common/base/wrench.hpp"

namespace spm {

/// A spring that pushes one way along a wrench, as a plane that is pressed does: what a hand felt
/// before a change, wherever it goes on to.
struct WrenchSpring {
  Wrench wrench;         ///< N and N m, with the hand at `at`
  HandPose at;           ///< where the hand was
  double stiffness = 0;  ///< N/m of the hand, above 0
  double turning = 0;    ///< N m/rad, 0 or more; 0: the torque stays the same until it has faded

  /// The wrench with the hand elsewhere. It never pulls.
  [[nodiscard]] Wrench wrench_at(const HandPose& hand) const noexcept;
  /// J that the spring of the force can give back there.
  [[nodiscard]] double energy_at(const HandPose& hand) const noexcept;
};

/// What a hand feels while objects that it touches are exchanged, added, removed or felt otherwise:
/// the spring of what it felt before becomes the law of what is there now, over change_seconds, and
/// never faster than change_rate. Both are felt in shares that depend on time alone, so that at
/// each moment the force is the gradient of one potential. The hand therefore gets no more energy
/// than the change of the potential is where it was made. A change while one is under way makes one
/// spring of what is felt, with the energy that it holds; it never lets go of what was felt. No
/// call allocates or throws.
class ForceBlend {
 public:
  /// `tick` in s, above 0.
  explicit ForceBlend(double tick) noexcept : tick_(tick) {}

  [[nodiscard]] bool running() const noexcept { return left_ > 0; }
  /// Begins, with all of what was felt before.
  void begin(const WrenchSpring& before) noexcept;
  /// Ends at once.
  void end() noexcept { left_ = 0; }

  /// What is felt in this tick, N and N m, `ticks` after the last one, where the law gives `law`.
  [[nodiscard]] Wrench next(const Wrench& law, const HandPose& hand, std::uint64_t ticks) noexcept;
  /// How much of the law is felt, 0 to 1.
  [[nodiscard]] double law_share() const noexcept { return 1 - left_; }
  /// J that what was felt before can still give back.
  [[nodiscard]] double energy_at(const HandPose& hand) const noexcept {
    return left_ * before_.energy_at(hand);
  }

 private:
  double tick_;
  WrenchSpring before_;
  double left_ = 0;  ///< the share of what was felt before
};

/// Whether two wrenches differ by more than a command may change in `seconds`.
[[nodiscard]] bool differ_by_a_step(const Wrench& one, const Wrench& other,
                                    double seconds) noexcept;

}  // namespace spm
