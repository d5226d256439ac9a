// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_state.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "servo/app/app_client.hpp"
#include "servo/app/app_info.hpp"
#include "servo/client/spm_client.h"
#include "servo/shared/fixed_text.hpp"
#include "servo/shared/shared_buckets.hpp"
#include "servo/shared/shared_words.hpp"

namespace spm::servo {

namespace {

static_assert(SPM_MAX_CONTACTS == max_patches);

void pack(double (&to)[3], const Vector3& from) noexcept {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

void pack(double (&to)[4], const Eigen::Quaterniond& from) noexcept {
  to[0] = from.w();
  to[1] = from.x();
  to[2] = from.y();
  to[3] = from.z();
}

std::uint32_t bit(bool on, std::uint32_t mask) noexcept { return on ? mask : 0; }

/// Increases a word that only the loop writes.
void raise(std::uint64_t& shared, std::uint64_t by) noexcept {
  store_relaxed(shared, load_relaxed(shared) + by);
}

void raise_to(std::uint64_t& shared, std::uint64_t value) noexcept {
  store_relaxed(shared, std::max(load_relaxed(shared), value));
}

spm_shared_device_counts packed(const DeviceCounters& device, std::uint32_t last_cause) noexcept {
  return {device.contact_ticks,   device.cap_hits,         device.slew_hits,     device.force_max,
          device.energy,          device.generated_max,    last_cause,           0,
          device.torque_cap_hits, device.torque_slew_hits, device.tool_cap_hits, device.torque_max};
}

spm_shared_object packed(const AppObject& object) noexcept {
  spm_shared_object to{};
  to.id = object.id;
  pack(to.position, object.pose.position);
  pack(to.orientation, object.pose.rotation);
  to.scale = object.pose.scale;
  pack(to.force, object.reaction.force);
  pack(to.torque, object.reaction.torque);
  to.silent = object.silent;
  to.asset = object.asset;
  to.flags = bit(object.movable, SPM_OBJECT_MOVABLE) | bit(object.contact, SPM_OBJECT_CONTACT) |
             bit(object.driven, SPM_OBJECT_DRIVEN);
  if (object.settings == nullptr) return to;
  const PlacedObject& felt = *object.settings;
  to.stiffness = felt.force.stiffness;
  to.friction_stick = felt.effects.friction.stick;
  to.friction_slide = felt.effects.friction.slide;
  to.damping = felt.effects.damping;
  to.texture_amplitude = felt.effects.texture.amplitude;
  to.texture_wavelength = felt.effects.texture.wavelength;
  to.texture_seed = felt.effects.texture.seed;
  to.method = static_cast<std::uint32_t>(felt.force.method);
  to.stabilized = object.stabilized ? 1 : 0;
  return to;
}

spm_shared_contact packed(const ContactPatch& patch, std::uint64_t object) noexcept {
  spm_shared_contact to{};
  to.object = object;
  pack(to.place, patch.place);
  pack(to.normal, patch.normal);
  pack(to.force, patch.force);
  to.depth = patch.depth;
  return to;
}

/// Publishes where the tools touch; the number of a device's contacts stands with the device.
void store_contacts(spm_shared_snapshot& to, const AppTick& tick, std::size_t devices) noexcept {
  for (std::size_t i = 0; i < devices; ++i) {
    const std::span<const ContactPatch> patches = tick.devices[i].patches;
    for (std::size_t k = 0; k < patches.size() && k < SPM_MAX_CONTACTS; ++k) {
      const std::uint32_t number = patches[k].object;
      std::uint64_t object = number < tick.ids.size() ? tick.ids[number] : number;
      if (number >= tool_of_device) object = SPM_TOOL_OF_DEVICE + (number - tool_of_device);
      store_record(to.contacts[i][k], packed(patches[k], object));
    }
  }
}

}  // namespace

Result<std::unique_ptr<AppState>> AppState::create(double rate_hz, const AppNames& names) {
  auto memory = SharedMemory::create("spm-servo-state", sizeof(spm_shared_state));
  if (!memory) return tl::make_unexpected(std::move(memory.error()));
  std::unique_ptr<AppState> state(new AppState(std::move(*memory)));
  if (!state->memory_.close_to_others()) {
    return fail(ExitCode::internal,
                "the shared memory of the loop's state could not be sealed; report it as a bug");
  }
  spm_shared_state& shared = state->shared();
  shared.magic = SPM_STATE_MAGIC;
  shared.layout_version = SPM_LAYOUT_VERSION;
  shared.bytes = sizeof(spm_shared_state);
  copy_text(shared.daemon_version, SPM_VERSION);
  shared.process = static_cast<std::uint32_t>(getpid());
  shared.rate_hz = rate_hz;
  state->rename(names);
  return state;
}

AppState::AppState(SharedMemory memory) noexcept : memory_(std::move(memory)) {}

AppState::~AppState() { end(); }

void AppState::end() noexcept { store_release(shared().ended, 1); }

void AppState::rename(const AppNames& names) {
  const std::unique_ptr<spm_shared_info> info = info_of(names);
  spm_shared_state& to = shared();
  write_sequenced(to.info_sequence, [&] { store_words(&to.info, info.get(), sizeof *info); });
  devices_.store(info->device_count, std::memory_order_relaxed);
  assets_.store(info->asset_count, std::memory_order_relaxed);
}

void AppState::publish(const AppTick& tick) noexcept {
  spm_shared_state& state = shared();
  const std::uint64_t number = load_relaxed(state.published);
  spm_shared_snapshot& to = state.snapshots[number & 1];
  const std::size_t devices = std::min<std::size_t>(tick.devices.size(), SPM_MAX_DEVICES);
  const std::size_t objects = std::min<std::size_t>(tick.objects.size(), SPM_MAX_OBJECTS);
  write_sequenced(to.sequence, [&] {
    store_relaxed(to.tick, tick.tick);
    store_relaxed(to.time_ns, tick.time_ns);
    store_relaxed(to.device_count, static_cast<std::uint32_t>(devices));
    store_relaxed(to.object_count, static_cast<std::uint32_t>(objects));
    store_relaxed(to.object_total, std::max<std::uint64_t>(tick.object_total, objects));
    for (std::size_t i = 0; i < devices; ++i) {
      store_record(to.devices[i], packed(i, tick.devices[i]));
    }
    for (std::size_t i = 0; i < objects; ++i) {
      store_record(to.objects[i], servo::packed(tick.objects[i]));
    }
    store_contacts(to, tick, devices);
  });
  store_release(state.published, number + 1);
  store_relaxed(state.heartbeat_ns, tick.time_ns);
}

void AppState::count(const AppLoop& loop) noexcept {
  spm_shared_loop& to = shared().loop;
  const std::size_t devices = std::min<std::size_t>(loop.devices.size(), SPM_MAX_DEVICES);
  const auto wake = static_cast<std::uint64_t>(std::max<std::int64_t>(loop.wake_ns, 0));
  const auto busy = static_cast<std::uint64_t>(std::max<std::int64_t>(loop.busy_ns, 0));
  const AppCounters commands = counters();
  write_sequenced(to.sequence, [&] {
    store_relaxed(to.time_ns, loop.time_ns);
    store_relaxed(to.ticks, loop.ticks);
    store_relaxed(to.missed, loop.missed);
    store_relaxed(to.skipped, loop.skipped);
    raise(to.busy_ns, busy);
    raise_to(to.wake_max_ns, wake);
    raise_to(to.busy_max_ns, busy);
    raise(to.wake[shared_bucket(loop.wake_ns)], 1);
    raise(to.busy[shared_bucket(loop.busy_ns)], 1);
    store_relaxed(to.taken, commands.taken);
    store_relaxed(to.refused, commands.refused);
    store_relaxed(to.garbage, commands.garbage);
    store_relaxed(to.degraded, loop.degraded);
    std::uint64_t held = 0, shortened = 0, coarse = 0;
    for (const DeviceCounters& device : loop.devices) {
      held += device.held;
      shortened += device.shortened;
      coarse += device.coarse;
    }
    store_relaxed(to.held, held);
    store_relaxed(to.shortened, shortened);
    store_relaxed(to.coarse, coarse);
    store_relaxed(to.device_count, static_cast<std::uint32_t>(devices));
    for (std::size_t i = 0; i < devices; ++i) {
      store_record(to.devices[i], servo::packed(loop.devices[i], seen_[i].last_cause));
    }
  });
}

void AppState::tell_clients(std::span<const AppClientReport> clients) noexcept {
  spm_shared_applications& to = shared().applications;
  const std::size_t count = std::min<std::size_t>(clients.size(), SPM_MAX_CLIENTS);
  write_sequenced(to.sequence, [&] {
    store_relaxed(to.count, static_cast<std::uint32_t>(count));
    std::uint32_t supervisors = 0, observers = 0;
    for (std::size_t i = 0; i < count; ++i) {
      supervisors |= bit(clients[i].supervisor, 1U << i);
      observers |= bit(clients[i].observer, 1U << i);
      spm_shared_application application{};
      application.connection = clients[i].connection;
      application.process = static_cast<std::uint32_t>(clients[i].process);
      copy_text(application.name, clients[i].application);
      store_words(&to.list[i], &application, sizeof application);
    }
    store_relaxed(to.supervisors, supervisors);
    store_relaxed(to.observers, observers);
  });
}

spm_shared_device AppState::packed(std::size_t index, const AppDevice& device) noexcept {
  Seen& seen = seen_[index];
  const bool cut = device.cause != ForceOff::none;
  seen.contacts += device.contact && !seen.contact ? 1 : 0;
  seen.cuts += cut && !seen.cut ? 1 : 0;
  seen.contact = device.contact;
  seen.cut = cut;
  if (cut) seen.last_cause = static_cast<std::uint32_t>(device.cause);

  spm_shared_device to{};
  pack(to.position, device.state.position);
  pack(to.orientation, device.state.orientation);
  pack(to.velocity, device.velocity);
  pack(to.force, device.wrench.force);
  pack(to.torque, device.wrench.torque);
  to.depth = device.depth;
  to.buttons = device.state.buttons;
  to.cause = static_cast<std::uint32_t>(device.cause);
  to.health = static_cast<std::uint32_t>(device.health);
  to.flags =
      bit(device.health != DeviceHealth::gone, SPM_DEVICE_CONNECTED) |
      bit(device.contact, SPM_DEVICE_CONTACT) | bit(device.force_capped, SPM_DEVICE_FORCE_CAPPED) |
      bit(device.torque_capped, SPM_DEVICE_TORQUE_CAPPED) |
      bit(device.tool_capped, SPM_DEVICE_TOOL_CAPPED) | bit(device.has_tool, SPM_DEVICE_TOOL) |
      bit(device.leadable, SPM_DEVICE_LEADABLE) | bit(device.led, SPM_DEVICE_LED);
  to.contacts = seen.contacts;
  to.cuts = seen.cuts;
  pack(to.proxy, device.proxy.position);
  pack(to.proxy_orientation, device.proxy.orientation);
  to.force_cap = device.force_cap;
  to.torque_cap = device.torque_cap;
  pack(to.angular_velocity, device.angular_velocity);
  pack(to.tool_position, device.tool.position);
  pack(to.tool_orientation, device.tool.orientation);
  to.contact_count =
      static_cast<std::uint32_t>(std::min<std::size_t>(device.patches.size(), SPM_MAX_CONTACTS));
  to.level = device.level;
  to.culled = device.culled;
  return to;
}

std::span<const AppCommand> AppState::take(std::int64_t now_ns) noexcept {
  const AppCommandLimits limits{assets_.load(std::memory_order_relaxed),
                                devices_.load(std::memory_order_relaxed), now_ns};
  taken_count_ = 0;
  now_ns_ = now_ns;
  std::size_t left = max_of_all;
  std::uint32_t next = first_client_;
  for (std::uint32_t turn = 0; turn < SPM_MAX_CLIENTS; ++turn) {
    const std::uint32_t client = (first_client_ + turn) % SPM_MAX_CLIENTS;
    const bool had_a_turn = left > 0;
    left -= take_from(client, std::min(left, max_of_client), limits);
    if (had_a_turn && left == 0) next = (client + 1) % SPM_MAX_CLIENTS;
  }
  first_client_ = next;
  return {taken_.data(), taken_count_};
}

/// Looks at up to `max_count` places of a ring. Returns how many it looked at.
std::size_t AppState::take_from(std::uint32_t client, std::size_t max_count,
                                const AppCommandLimits& limits) noexcept {
  ClientRing& ring = rings_[client];
  const std::uint32_t connection = ring.begin();
  if (connection != ring.adopted()) meet(client);
  if (connection != 0) {
    const std::uint64_t sign = ring.sign_of_life();
    Alive& alive = alive_[client];
    if (alive.connection != connection || alive.sign != sign) alive = {connection, sign, now_ns_};
  }
  std::size_t looked_at = 0;
  for (; connection != 0 && looked_at < max_count; ++looked_at) {
    spm_shared_command command;
    const RingEntry entry = ring.next(command);
    if (entry == RingEntry::empty) break;
    if (entry == RingEntry::garbage) {
      garbage_total_.fetch_add(1, std::memory_order_relaxed);
    } else {
      keep_or_refuse(ring, command, client, limits);
    }
  }
  ring.end();
  return looked_at;
}

/// Another client, or none, is now at this place.
void AppState::meet(std::uint32_t client) noexcept {
  ClientRing& ring = rings_[client];
  if (ring.adopted() != 0) {
    AppCommand& departure = taken_[taken_count_++];
    departure = AppCommand{};
    departure.action = AppAction::departure;
    departure.client = client;
    departure.connection = ring.adopted();
  }
  ring.adopt();
}

void AppState::keep_or_refuse(ClientRing& ring, const spm_shared_command& command,
                              std::uint32_t client, const AppCommandLimits& limits) noexcept {
  AppCommand& to = taken_[taken_count_];
  Refusal refusal = check_command(command, limits, to);
  // An id contains the connection that made it: nobody adds objects in another's name, and only a
  // supervisor removes another's.
  const bool of_owner =
      to.action == AppAction::add || (to.action == AppAction::remove && !ring.supervisor());
  if (refusal == Refusal::none && of_owner && to.object >> 32U != ring.adopted()) {
    refusal = Refusal::not_yours;
  }
  if (ring.observer()) refusal = Refusal::observer;
  if (refusal != Refusal::none) {
    ring.refuse(command.sequence, static_cast<std::uint32_t>(refusal));
    refused_total_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  to.client = client;
  to.connection = ring.adopted();
  to.supervisor = ring.supervisor();
  ++taken_count_;
  taken_total_.fetch_add(1, std::memory_order_relaxed);
}

double AppState::silence(std::uint32_t connection) const noexcept {
  for (const Alive& alive : alive_) {
    if (connection == 0 || alive.connection != connection) continue;
    return static_cast<double>(now_ns_ - alive.at_ns) * 1e-9;
  }
  return 0;
}

void AppState::refuse(const AppCommand& command, Refusal refusal) noexcept {
  refused_total_.fetch_add(1, std::memory_order_relaxed);
  ClientRing& ring = rings_[command.client];
  if (ring.begin() == command.connection && ring.adopted() == command.connection) {
    ring.refuse(command.sequence, static_cast<std::uint32_t>(refusal));
  }
  ring.end();
}

AppCounters AppState::counters() const noexcept {
  return {taken_total_.load(std::memory_order_relaxed),
          refused_total_.load(std::memory_order_relaxed),
          garbage_total_.load(std::memory_order_relaxed)};
}

}  // namespace spm::servo
