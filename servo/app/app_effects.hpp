// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/base/vector.hpp"
#include "common/base/wrench.hpp"
#include "common/contact/hand_effect.hpp"
#include "servo/app/pose_interpolator.hpp"
#include "servo/force/scene_force.hpp"
#include "servo/shared/app_command.hpp"
#include "servo/stabilize/braking_velocity.hpp"
#include "servo/stabilize/matched_damping.hpp"

namespace spm::servo {

/// The parts of what a device bears that all effects on it may have together. The rest is left to
/// the objects: with a contact of the stiffness `"auto"`, effects come to four fifths of the
/// stiffness at which the device begins to shake; with a contact's damping and the matched damping,
/// which each have the limit too, to less than the border that damping has at pi/2 of the delay.
inline constexpr double effects_stiffness_share = 1. / 3, effects_damping_share = 1. / 2;

/// The forces and effects that applications give to hands, in the world's frame. A force ends at
/// its deadline, an effect when it is removed, and both when their application leaves. Whatever
/// they become, they become it over change_seconds, and no faster than change_rate: a force and the
/// numbers of an effect go over, its point moves evenly as poses of objects do, and one that is
/// removed, or of an application that hangs, fades. Belongs to the loop; no call allocates or
/// throws.
class AppEffects {
 public:
  /// On one device, of all applications together.
  static constexpr std::size_t most_effects = 16;
  /// With those that fade.
  static constexpr std::size_t most_felt = 2 * most_effects;

  AppEffects() noexcept : devices_(SPM_MAX_DEVICES) {}

  /// Before the loop runs: what a device bears, per metre of the world (its `stable` stiffness is
  /// the effects' measure, its `stiffness` the limit of objects and effects together), the largest
  /// error of its position, m of the world, the length of a tick, s, and the delay of its forces in
  /// ticks.
  void know_device(std::uint32_t device, const FeltLimits& bears, double encoder_step, double tick,
                   double delay_ticks);

  /// The delay of a device's forces is another one now, ticks, and with it what the device holds
  /// stably, N per metre of the world.
  void set_delay(std::uint32_t device, double delay_ticks, double stable) noexcept;

  /// Before the loop runs: whether a device gives torque.
  void know_torque(std::uint32_t device, bool given) noexcept {
    if (Hand* const hand = find(device)) hand->torque = given;
  }
  [[nodiscard]] bool gives_torque(std::uint32_t device) const noexcept {
    return device < devices_.size() && devices_[device].torque;
  }

  /// An application pushes a device's hand by a wrench until a time, and no longer by what it gave
  /// before; N, and N m about the tool's origin. `client` is its place, below SPM_MAX_CLIENTS.
  void push(std::uint32_t device, std::uint32_t client, const Wrench& wrench,
            std::int64_t until_ns) noexcept;
  /// Sets an effect of an application, or changes the one that has its number. `object`: the place
  /// of a magnet's object in the scene.
  [[nodiscard]] Refusal set(const AppCommand& command, std::size_t object,
                            std::int64_t now_ns) noexcept;
  /// Removes an effect, or all of them on a device (SPM_ALL_EFFECTS); a supervisor all of all
  /// applications.
  [[nodiscard]] Refusal remove(const AppCommand& command) noexcept;
  /// An application is gone.
  void leave(std::uint32_t client, std::uint32_t connection) noexcept;
  /// An object is gone, and its magnets with it; what was felt of them fades.
  void drop(std::size_t object) noexcept;
  /// Once a tick: the effects that `is_left_alone(connection, motion)` by their application fade.
  template <class IsLeftAlone>
  void tell_silent(const IsLeftAlone& is_left_alone) noexcept {
    for (Hand& hand : devices_) {
      for (Effect& effect : hand.effects) {
        effect.silent = effect.connection != 0 && !effect.leaving &&
                        is_left_alone(effect.connection, effect.motion);
      }
    }
  }

  /// What applications add to a device's wrench in this tick, N, and N m about the tool's origin,
  /// world frame; effects give no torque. `tool` in m of the world, `ticks` since the last call;
  /// `force` and `assets`: the device's scene. Beside objects that are touched now, effects have
  /// what these leave of the stiffness that the device renders: their share goes there within
  /// change_seconds.
  [[nodiscard]] Wrench next(std::uint32_t device, const Vector3& tool, std::uint64_t ticks,
                            std::int64_t now_ns, const SceneForce& force,
                            std::span<const AssetView* const> assets) noexcept;
  /// A tick in which the device's force was off.
  void rest(std::uint32_t device) noexcept;

 private:
  struct Effect {
    std::uint32_t connection = 0;  ///< of who made it; 0: this place is free
    std::uint32_t number = 0;
    HandEffect what;  ///< as it is felt, on its way from `begun` to `wanted`
    HandEffect begun, wanted;
    std::size_t object = 0, wanted_object = 0;
    PoseInterpolator motion{{}, {}};  ///< of its point, and of its axis as the z axis
    double shown = 0;                 ///< how far it faded in, 0 to 1
    Vector3 felt = Vector3::Zero();   ///< N, in the last tick
    double size = 0;                  ///< N, at most, of its pull were it shown whole, then
    bool leaving = false;             ///< it fades, and is then gone
    bool silent = false;              ///< its application hangs
    bool other = false;               ///< it fades, and is then what is wanted
  };
  struct Push {
    Wrench wrench, felt;
    std::int64_t until_ns = 0;
  };
  struct Hand {
    std::array<Effect, most_felt> effects{};
    std::array<Push, SPM_MAX_CLIENTS> pushes{};
    FeltLimits limits;                                       ///< of all effects together
    double whole = std::numeric_limits<double>::infinity();  ///< N/m, of objects and effects
    double tick = 1e-3;                                      ///< s
    double left = 1;  ///< of the effects' stiffness beside the objects, 0 to 1
    double leak = 0;  ///< s: damping that a sampled spring needs, for each N/m
    BrakingVelocity velocity{0, 1e-3};
    double stiffness_share = 1, damping_share = 1;            ///< of each effect, within the limits
    double felt_stiffness_share = 1, felt_damping_share = 1;  ///< on their way to these
    double stiffness = 0;  ///< N/m, of all of them within the limits
    double felt = 0;       ///< N, of all of them were they shown whole, in the last tick
    Vector3 fading = Vector3::Zero();  ///< N, of magnets whose objects are gone
    bool any = false;
    bool torque = false;  ///< the device gives it
  };

  static void settle(Hand& hand) noexcept;
  static void make_room(Hand& hand, double touched, double seconds) noexcept;
  [[nodiscard]] static Effect* place_for(Hand& hand, const AppCommand& command) noexcept;
  static void remove(Effect& effect) noexcept { effect.leaving = true; }
  static void go_on(Hand& hand, Effect& effect, double seconds, double felt,
                    std::int64_t now_ns) noexcept;
  [[nodiscard]] Hand* find(std::uint32_t device) noexcept {
    return device < devices_.size() ? &devices_[device] : nullptr;
  }

  std::vector<Hand> devices_;
};

}  // namespace spm::servo
