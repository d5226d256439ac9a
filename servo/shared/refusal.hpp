// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace spm::servo {

/// Why a command was not followed. The numbers are part of spm_client.h.
enum class Refusal : std::uint8_t {
  none,
  unknown_kind,      ///< this layout has no command of this kind
  not_finite,        ///< a number is not finite
  out_of_range,      ///< a number is beyond its limit
  unknown_asset,     ///< no such asset is served
  unknown_device,    ///< no such device
  unknown_object,    ///< no such object
  not_yours,         ///< an object of another application, or to be removed by the scene
  not_movable,       ///< the scene says that the object stays where it is
  too_many_objects,  ///< there is no room for another object
  too_late,          ///< the loop came to it after its deadline
  clutch_held,       ///< another application holds the device's clutch
  no_torque,         ///< the device gives no torque
  too_many_effects,  ///< there is no room for another effect on the device
  unknown_effect,    ///< the application has no effect of that number on the device
  unlike_tool,       ///< an object that the scene's tool cannot meet, by form or scale
  not_led,           ///< the device's hand goes its own way
  hand_held,         ///< another application leads the device's hand
  unlike_method,     ///< the object's asset, probe or effects are not of that method
  supervisor_only,   ///< what holds for the whole scene is changed by a supervisor alone
  nothing_given,     ///< a material of which no field is given
  observer,          ///< an observer changes nothing
};

inline constexpr std::size_t refusal_count = 22;

/// What was wrong and what to do about it: a sentence without its full stop.
[[nodiscard]] const char* to_sentence(Refusal refusal) noexcept;

}  // namespace spm::servo
