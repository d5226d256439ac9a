// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "servo/client/client.hpp"
#include "servo/client/spm_client.h"
#include "servo/client/state_reader.hpp"
#include "servo/shared/shared_buckets.hpp"

namespace {

using namespace spm::servo;

/// Looks something up behind a sequence lock by `find`, which returns whether it is there.
template <class Find>
int look_up(const std::uint64_t& sequence, const Find& find) noexcept {
  bool found = false;
  if (!read_behind(sequence, [&] { found = find(); })) return SPM_CLIENT_BUSY;
  return found ? SPM_CLIENT_OK : SPM_CLIENT_NOT_THERE;
}

spm_client_loop public_loop(const spm_shared_loop& from) noexcept {
  spm_client_loop to{};
  to.time_ns = load_relaxed(from.time_ns);
  to.ticks = load_relaxed(from.ticks);
  to.missed = load_relaxed(from.missed);
  to.skipped = load_relaxed(from.skipped);
  to.busy_ns = load_relaxed(from.busy_ns);
  to.wake_max_ns = load_relaxed(from.wake_max_ns);
  to.busy_max_ns = load_relaxed(from.busy_max_ns);
  to.taken = load_relaxed(from.taken);
  to.refused = load_relaxed(from.refused);
  to.garbage = load_relaxed(from.garbage);
  to.degraded = load_relaxed(from.degraded);
  to.held = load_relaxed(from.held);
  to.shortened = load_relaxed(from.shortened);
  to.coarse = load_relaxed(from.coarse);
  static_assert(sizeof to.wake == sizeof from.wake && sizeof to.busy == sizeof from.busy);
  load_words(to.wake, from.wake, sizeof to.wake);
  load_words(to.busy, from.busy, sizeof to.busy);
  return to;
}

spm_client_device_counts public_counts(const spm_shared_device_counts& from) noexcept {
  spm_client_device_counts to{};
  to.last_cause = from.last_cause;
  to.contact_ticks = from.contact_ticks;
  to.cap_hits = from.cap_hits;
  to.slew_hits = from.slew_hits;
  to.force_max = from.force_max;
  to.energy = from.energy;
  to.generated_max = from.generated_max;
  to.torque_cap_hits = from.torque_cap_hits;
  to.torque_slew_hits = from.torque_slew_hits;
  to.tool_cap_hits = from.tool_cap_hits;
  to.torque_max = from.torque_max;
  return to;
}

spm_client_application public_application(const spm_shared_application& from) noexcept {
  spm_client_application to{};
  to.connection = from.connection;
  to.process = from.process;
  std::memcpy(to.name, from.name, sizeof to.name - 1);
  return to;
}

}  // namespace

int spm_client_read_loop(const spm_client* client, spm_client_loop* loop) {
  if (client == nullptr || loop == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  if (const int code = there(*client); code != SPM_CLIENT_OK) return code;
  const spm_shared_loop& shared = look(*client).loop;
  spm_client_loop found{};
  const int code = look_up(shared.sequence, [&] {
    found = public_loop(shared);
    return found.ticks > 0;
  });
  return code == SPM_CLIENT_OK ? give(loop, found) : code;
}

uint64_t spm_client_bucket_end(uint32_t bucket) {
  return bucket < SPM_BUCKETS ? bucket_end_ns(bucket) : 0;
}

int spm_client_read_device_counts(const spm_client* client, uint32_t device,
                                  spm_client_device_counts* counts) {
  if (client == nullptr || counts == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  if (const int code = there(*client); code != SPM_CLIENT_OK) return code;
  const spm_shared_loop& shared = look(*client).loop;
  spm_shared_device_counts found{};
  const int code = look_up(shared.sequence, [&] {
    const bool there = device < SPM_MAX_DEVICES && device < load_relaxed(shared.device_count);
    if (there) found = load_record(shared.devices[device]);
    return there;
  });
  return code == SPM_CLIENT_OK ? give(counts, public_counts(found)) : code;
}

int spm_client_read_application(const spm_client* client, uint32_t index,
                                spm_client_application* application) {
  if (client == nullptr || application == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  if (const int code = there(*client); code != SPM_CLIENT_OK) return code;
  const spm_shared_applications& shared = look(*client).applications;
  spm_shared_application found{};
  std::uint32_t supervisors = 0, observers = 0;
  const int code = look_up(shared.sequence, [&] {
    const bool there = index < SPM_MAX_CLIENTS && index < load_relaxed(shared.count);
    if (there) load_words(&found, &shared.list[index], sizeof found);
    supervisors = load_relaxed(shared.supervisors);
    observers = load_relaxed(shared.observers);
    return there;
  });
  if (code != SPM_CLIENT_OK) return code;
  spm_client_application seen = public_application(found);
  const std::uint32_t bit = 1U << index;
  if ((supervisors & bit) != 0) seen.role = SPM_CLIENT_SUPERVISOR;
  if ((observers & bit) != 0) seen.role = SPM_CLIENT_OBSERVER;
  return give(application, seen);
}
