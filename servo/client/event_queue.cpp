// SPDX-License-Identifier: Apache-2.0
#include "servo/client/event_queue.hpp"

#include <bit>

namespace spm::servo {

void EventQueue::look(std::uint64_t tick,
                      const std::array<spm_shared_device, SPM_MAX_DEVICES>& devices,
                      std::uint32_t count) noexcept {
  count_ = taken_ = 0;
  tick_ = tick;
  for (std::uint32_t device = 0; device < count; ++device) {
    if (device < seen_count_) compare(device, seen_[device], devices[device]);
    seen_[device] = devices[device];
  }
  seen_count_ = count;
}

void EventQueue::compare(std::uint32_t device, const spm_shared_device& before,
                         const spm_shared_device& now) noexcept {
  const bool was_there = (before.flags & SPM_DEVICE_CONNECTED) != 0;
  const bool is_there = (now.flags & SPM_DEVICE_CONNECTED) != 0;
  if (was_there && !is_there) tell(SPM_CLIENT_DEVICE_LOST, device, 0);
  if (!was_there && is_there) tell(SPM_CLIENT_DEVICE_FOUND, device, 0);

  // The counters show a contact that began between two looks, even if it ended again.
  const bool touched = (before.flags & SPM_DEVICE_CONTACT) != 0;
  const bool touches = (now.flags & SPM_DEVICE_CONTACT) != 0;
  const bool began = now.contacts != before.contacts;
  if (touched && (began || !touches)) tell(SPM_CLIENT_CONTACT_ENDED, device, 0);
  if (began) tell(SPM_CLIENT_CONTACT_BEGAN, device, 0);
  if (began && !touches) tell(SPM_CLIENT_CONTACT_ENDED, device, 0);

  const bool was_off = before.cause != SPM_CLIENT_FORCE_ON;
  const bool is_off = now.cause != SPM_CLIENT_FORCE_ON;
  const bool cut = now.cuts != before.cuts;
  if (was_off && (cut || !is_off)) tell(SPM_CLIENT_FORCE_BACK, device, 0);
  if (cut || (was_off && is_off && before.cause != now.cause)) {
    tell(SPM_CLIENT_FORCE_CUT, device, now.cause);
  }
  if (cut && !is_off) tell(SPM_CLIENT_FORCE_BACK, device, 0);

  for (std::uint32_t changed = before.buttons ^ now.buttons; changed != 0; changed &= changed - 1) {
    const auto button = static_cast<std::uint32_t>(std::countr_zero(changed));
    const bool pressed = (now.buttons >> button & 1U) != 0;
    tell(pressed ? SPM_CLIENT_BUTTON_PRESSED : SPM_CLIENT_BUTTON_RELEASED, device, button);
  }
}

void EventQueue::tell(std::uint32_t kind, std::uint32_t device, std::uint32_t value) noexcept {
  spm_client_event& event = events_[count_++];
  event.size = sizeof event;
  event.kind = kind;
  event.device = device;
  event.value = value;
  event.tick = tick_;
}

}  // namespace spm::servo
