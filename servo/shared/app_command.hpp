// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/placement.hpp"
#include "common/contact/force_law.hpp"
#include "common/contact/hand_effect.hpp"
#include "common/contact/surface_texture.hpp"
#include "servo/shared/refusal.hpp"
#include "servo/shared/shared_layout.h"

namespace spm::servo {

/// The kind of a request.
enum class AppAction : std::uint8_t {
  add,            ///< an object of an asset that the daemon serves
  move,           ///< a pose of an object
  place,          ///< a pose of an object, at once
  remove,         ///< an object that an application added
  material,       ///< how an object feels
  clutch,         ///< the device's hand moves freely, while the tool stays
  force_cap,      ///< a device's force is held below a cap of the application
  push,           ///< a device's hand is pushed for a while
  effect,         ///< an effect on a device's hand is set or changed
  remove_effect,  ///< an effect is removed, or all of a device
  acknowledge,    ///< a fault is over, and the device's force may come back
  lead,           ///< where the hand of a simulated device is to go, or that it is let go
  method,         ///< the method by which an object is felt
  stabilize,      ///< stabilization of the whole scene on or off
  departure,      ///< no request: the application is gone, and its objects belong to nobody now
};

/// How an object feels. What a command does not give stays as it is.
struct AppMaterial {
  std::uint32_t given = 0;    ///< SPM_MATERIAL_ bits
  double stiffness = 0;       ///< N/m
  double friction_stick = 0;  ///< mu at rest, at least `friction_slide`
  double friction_slide = 0;  ///< mu in motion
  double damping = 0;         ///< N s/m
  TextureSettings texture;
};

/// A command whose every number was found finite and in range.
struct AppCommand {
  AppAction action = AppAction::move;
  bool supervisor = false;       ///< the client may change what is another's
  bool on = false;               ///< clutch, stabilize; lead: false lets go
  std::uint32_t client = 0;      ///< below SPM_MAX_CLIENTS
  std::uint32_t connection = 0;  ///< of the client, from 1, never used again
  std::uint32_t index = 0;       ///< add: asset; all others that name one: device
  Method method = Method::spm;   ///< method
  std::uint64_t sequence = 0;
  std::uint64_t object = 0;      ///< id; its upper half is the connection that added the object
  std::int64_t deadline_ns = 0;  ///< of CLOCK_MONOTONIC; 0 or less: none
  Placement pose;                ///< the scale has a meaning with `add` alone
  double period = 0;     ///< s, move: until the next pose; 0 if the application does not say
  double force_cap = 0;  ///< N
  AppMaterial material;
  Vector3 force = Vector3::Zero();   ///< N, push
  Vector3 torque = Vector3::Zero();  ///< N m, push
  double hold = 0;                   ///< s, push: how long it acts; lead: how long it holds
  std::uint32_t effect_number = 0;   ///< the application's own
  HandEffect effect;
};

/// Limits of what an application may request. Positions: a room, far beyond any device's workspace.
/// Stiffness: ten times what the stiffest desktop devices render. Friction: dry rubber has about 1
/// (this limit is the scene's too). Damping, texture and scale: far beyond what can be felt. Forces
/// and torques: no device has as much.
inline constexpr double app_farthest = 100;    // m
inline constexpr double app_min_scale = 1e-4;  // scenes in micrometres need it
inline constexpr double app_max_scale = 1e4;
inline constexpr double app_longest_period = 1;       // s
inline constexpr double app_max_stiffness = 1e5;      // N/m
inline constexpr double app_max_friction = 10;        // mu
inline constexpr double app_max_damping = 1e3;        // N s/m
inline constexpr double app_max_amplitude = 0.1;      // m
inline constexpr double app_min_wavelength = 1e-6;    // m, if there is an amplitude
inline constexpr double app_max_wavelength = 1;       // m
inline constexpr double app_max_force_cap = 1e3;      // N; no device has as much
inline constexpr double app_max_force = 1e3;          // N, of a push and of an effect
inline constexpr double app_max_torque = 1e2;         // N m
inline constexpr double app_min_hold = 1e-6;          // s
inline constexpr double app_max_hold = 1;             // s
inline constexpr double app_min_spacing = 1e-5;       // m, of detents
inline constexpr double app_quaternion_slack = 1e-3;  // of its length; single precision needs it

/// What commands are checked against.
struct AppCommandLimits {
  std::uint32_t assets = 0;
  std::uint32_t devices = 0;
  std::int64_t now_ns = 0;  ///< of CLOCK_MONOTONIC
};

/// A number that was not finite or beyond its bounds. The name is that of the field, null for none.
struct WrongNumber {
  const char* name = nullptr;
  double value = 0, least = 0, most = 0;
};

/// Reads a command that an application wrote. `from` must be a copy in private memory, which cannot
/// change any more. `to` is valid only if nothing was refused; the caller fills in who sent it.
/// Whether the object exists is not checked here. `wrong`, which may be null, is the number that
/// was refused.
[[nodiscard]] Refusal check_command(const spm_shared_command& from, const AppCommandLimits& limits,
                                    AppCommand& to, WrongNumber* wrong = nullptr) noexcept;

}  // namespace spm::servo
