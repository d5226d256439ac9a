// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/vector.hpp"
#include "common/contact/hand_effect.hpp"
#include "servo/force/braking_velocity.hpp"
#include "servo/force/matched_damping.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/shared/app_command.hpp"

namespace spm::servo {

/// The parts of what a device bears that all effects on it may have together. The rest is left to
/// the objects: with a contact of the stiffness `"auto"`, effects come to four fifths of the
/// stiffness at which the device begins to shake; with a contact's damping and the matched damping,
/// which each have the limit too, to less than the border that damping has at pi/2 of the delay.
inline constexpr double effects_stiffness_share = 1. / 3, effects_damping_share = 1. / 2;
/// An effect that is new, or on a device whose force was off, fades in over this, s.
inline constexpr double effect_fade = 0.1;

/// The forces and effects that applications give to hands, in the world's frame. A force ends at
/// its deadline, an effect when it is removed, and both when their application leaves. Belongs to
/// the loop; no call allocates or throws.
class AppEffects {
 public:
  /// On one device, of all applications together.
  static constexpr std::size_t most_effects = 16;

  AppEffects() noexcept : devices_(SPM_MAX_DEVICES) {}

  /// Before the loop runs: what a device bears, per metre of the world, the largest error of its
  /// position, m of the world, the length of a tick, s, and the delay of its forces in ticks.
  void know_device(std::uint32_t device, const FeltLimits& bears, double encoder_step, double tick,
                   double delay_ticks);

  /// An application pushes a device's hand by `force`, N, until a time, and no longer by what it
  /// gave before. `client` is its place, below SPM_MAX_CLIENTS.
  void push(std::uint32_t device, std::uint32_t client, const Vector3& force,
            std::int64_t until_ns) noexcept;
  /// Sets an effect of an application, or changes the one that has its number. `object`: the place
  /// of a magnet's object in the scene.
  [[nodiscard]] Refusal set(const AppCommand& command, std::size_t object) noexcept;
  /// Removes an effect, or all of them on a device (SPM_ALL_EFFECTS); a supervisor all of all
  /// applications.
  [[nodiscard]] Refusal remove(const AppCommand& command) noexcept;
  /// An application is gone.
  void leave(std::uint32_t client, std::uint32_t connection) noexcept;
  /// An object is gone, and its magnets with it.
  void drop(std::size_t object) noexcept;

  /// What applications add to a device's force in this tick, N, world frame. `tool` in m of the
  /// world, `ticks` since the last call; `force` and `assets`: the device's scene.
  [[nodiscard]] Vector3 next(std::uint32_t device, const Vector3& tool, std::uint64_t ticks,
                             std::int64_t now_ns, const SceneForce& force,
                             std::span<const AssetView* const> assets) noexcept;
  /// A tick in which the device's force was off.
  void rest(std::uint32_t device) noexcept;

 private:
  struct Effect {
    std::uint32_t connection = 0;  ///< of who made it; 0: this place is free
    std::uint32_t number = 0;
    HandEffect what;
    std::size_t object = 0;
    double shown = 0;  ///< how far it faded in, 0 to 1
  };
  struct Push {
    Vector3 force = Vector3::Zero();
    std::int64_t until_ns = 0;
  };
  struct Hand {
    std::array<Effect, most_effects> effects{};
    std::array<Push, SPM_MAX_CLIENTS> pushes{};
    FeltLimits limits;  ///< of all effects together
    double fade_step = 1;
    double leak = 0;  ///< s: damping that a sampled spring needs, for each N/m
    BrakingVelocity velocity{0, 1e-3};
    double stiffness_share = 1, damping_share = 1;  ///< of each effect, within the limits
    bool any = false;
  };

  static void settle(Hand& hand) noexcept;
  [[nodiscard]] Hand* find(std::uint32_t device) noexcept {
    return device < devices_.size() ? &devices_[device] : nullptr;
  }

  std::vector<Hand> devices_;
};

}  // namespace spm::servo
