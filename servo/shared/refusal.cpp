// SPDX-License-Identifier: Apache-2.0
#include "servo/shared/refusal.hpp"

namespace spm::servo {

const char* to_sentence(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::none:
      return "nothing was refused";
    case Refusal::unknown_kind:
      return "a command of an unknown kind: something writes into the library's memory";
    case Refusal::not_finite:
      return "a number is not finite: check what the application computes it from";
    case Refusal::out_of_range:
      return "a number is out of range: spm_client.h tells the limits";
    case Refusal::unknown_asset:
      return "the daemon serves no such asset: add an object with it to the scene";
    case Refusal::unknown_device:
      return "there is no such device: the daemon's device count tells how many there are";
    case Refusal::unknown_object:
      return "there is no such object: it was removed, or never added";
    case Refusal::not_yours:
      return "the object belongs to another application or to the scene: only who added it may "
             "remove it, and only who added it or was the first to move or change it may do that";
    case Refusal::not_movable:
      return "the object stays where it is: set 'movable = true' for it in the scene";
    case Refusal::too_many_objects:
      return "there is no room for another object: remove one first";
    case Refusal::too_late:
      return "its deadline was over: send sooner, or with a later deadline";
    case Refusal::clutch_held:
      return "another application holds the clutch of this device: wait until it lets go or leaves";
    case Refusal::no_torque:
      return "this device gives no torque: send the force alone, with a torque of zero";
    case Refusal::too_many_effects:
      return "there is no room for another effect on this device: remove one first";
    case Refusal::unknown_effect:
      return "this application has no effect of that number on the device: it was removed, or its "
             "object was";
    case Refusal::unlike_tool:
      return "the scene's tool cannot meet such an object: beside a full tool give one of a full "
             "asset at the tool's own scale, beside a sparse tool one of a sparse asset";
    case Refusal::not_led:
      return "the hand of this device goes its own way: only that of --device sim:hand=live is led";
    case Refusal::hand_held:
      return "another application leads the hand of this device: wait until it lets go or leaves";
    case Refusal::unlike_method:
      return "the object cannot be felt by this method: paper needs a full asset, and friction and "
             "texture of its own; the others need a point or a ball as the probe, and smoothing is "
             "of spm alone";
    case Refusal::supervisor_only:
      return "stabilization holds for the whole scene: connect in the role of a supervisor";
    case Refusal::nothing_given:
      return "the material gives nothing: name what it changes among its fields, such as "
             "SPM_CLIENT_STIFFNESS";
    case Refusal::observer:
      return "an observer only watches: connect in the role of an application";
  }
  return "refused for a reason that this version does not know";
}

}  // namespace spm::servo
