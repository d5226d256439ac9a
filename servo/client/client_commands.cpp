// SPDX-License-Identifier: Apache-2.0
// The commands of spm_client.h: each is checked as the daemon will check it, and put into the ring.
#include <cmath>
#include <ctime>

#include "servo/client/client.hpp"
#include "servo/client/last_error.hpp"
#include "servo/client/state_reader.hpp"
#include "servo/shared/app_command.hpp"
#include "servo/shared/shared_words.hpp"

namespace {

using namespace spm::servo;

static_assert(int{SPM_CLIENT_STIFFNESS} == int{SPM_MATERIAL_STIFFNESS});
static_assert(int{SPM_CLIENT_FRICTION} == int{SPM_MATERIAL_FRICTION});
static_assert(int{SPM_CLIENT_DAMPING} == int{SPM_MATERIAL_DAMPING});
static_assert(int{SPM_CLIENT_TEXTURE} == int{SPM_MATERIAL_TEXTURE});

static_assert(int{SPM_CLIENT_SPRING} == int{SPM_EFFECT_SPRING});
static_assert(int{SPM_CLIENT_VISCOUS} == int{SPM_EFFECT_VISCOUS});
static_assert(int{SPM_CLIENT_MAGNET} == int{SPM_EFFECT_MAGNET});
static_assert(int{SPM_CLIENT_DETENTS} == int{SPM_EFFECT_DETENTS});
static_assert(SPM_CLIENT_ALL_EFFECTS == SPM_ALL_EFFECTS);

static_assert(int{SPM_CLIENT_METHOD_SPM} == int(spm::Method::spm));
static_assert(int{SPM_CLIENT_METHOD_PAPER} == int(spm::Method::paper));
static_assert(int{SPM_CLIENT_METHOD_PROXY} == int(spm::Method::proxy));

constexpr double longest_deadline = 1e6;  // s

std::int64_t monotonic_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// Fills in a pose. False if it has the size of no version.
bool read_pose(const spm_client_pose* pose, spm_shared_command& to) noexcept {
  if (pose == nullptr || pose->size < sizeof *pose) return false;
  if (!(pose->deadline >= 0 && pose->deadline <= longest_deadline)) return false;
  std::memcpy(to.position, pose->position, sizeof to.position);
  std::memcpy(to.orientation, pose->orientation, sizeof to.orientation);
  to.period = pose->period;
  if (pose->deadline > 0) {
    to.deadline_ns = monotonic_ns() + static_cast<std::int64_t>(pose->deadline * 1e9);
  }
  return true;
}

bool read_material(const spm_client_material* material, spm_shared_command& to) noexcept {
  if (material == nullptr || material->size < sizeof *material) return false;
  to.fields = material->fields;
  to.stiffness = material->stiffness;
  to.friction_stick = material->friction_stick;
  to.friction_slide = material->friction_slide;
  to.damping = material->damping;
  to.texture_amplitude = material->texture_amplitude;
  to.texture_wavelength = material->texture_wavelength;
  to.texture_seed = material->texture_seed;
  return true;
}

/// Whether a command moves or changes an object that has to be there.
bool is_of_object(const spm_shared_command& command) noexcept {
  switch (command.kind) {
    case SPM_COMMAND_MOVE:
    case SPM_COMMAND_PLACE:
    case SPM_COMMAND_REMOVE:
    case SPM_COMMAND_MATERIAL:
    case SPM_COMMAND_METHOD:
      return true;
    default:
      return false;
  }
}

/// Checks that the object is in the scene, and may be moved. One that this client has just added
/// may not be there yet, and of a scene with more than is told any may be.
int checked_object(const spm_client& client, const spm_shared_command& command) noexcept {
  if (command.object >> 32U == client.connection().number()) return SPM_CLIENT_OK;
  bool told = false, found = false, movable = false;
  const int result = read_tick(client, [&](const spm_shared_snapshot& snapshot) {
    told = load_relaxed(snapshot.object_total) <= object_count(snapshot);
    found = movable = false;
    for (std::uint32_t i = 0; i < object_count(snapshot) && !found; ++i) {
      found = load_relaxed(snapshot.objects[i].id) == command.object;
      movable = found && (load_relaxed(snapshot.objects[i].flags) & SPM_OBJECT_MOVABLE) != 0;
    }
    return true;
  });
  if (result == SPM_CLIENT_NO_DAEMON) return failed(result);
  if (result != SPM_CLIENT_OK || !told) return SPM_CLIENT_OK;
  if (!found) return failed(SPM_CLIENT_NOT_THERE, to_sentence(Refusal::unknown_object));
  const bool moves = command.kind == SPM_COMMAND_MOVE || command.kind == SPM_COMMAND_PLACE;
  return moves && !movable ? failed(SPM_CLIENT_NOT_MOVABLE) : SPM_CLIENT_OK;
}

/// Checks a command now, as the daemon would.
int checked(const spm_client& client, const spm_shared_command& command) noexcept {
  if (const int gone = there(client); gone != SPM_CLIENT_OK) return failed(gone);
  AppCommandLimits limits;
  const bool read = read_info(client.connection().state(), [&](const spm_shared_info& info) {
    limits.assets = load_relaxed(info.asset_count);
    limits.devices = load_relaxed(info.device_count);
  });
  if (!read) return failed(SPM_CLIENT_BUSY);
  AppCommand ignored;
  WrongNumber number;
  const Refusal refusal = check_command(command, limits, ignored, &number);
  switch (refusal) {
    case Refusal::none:
      return is_of_object(command) ? checked_object(client, command) : SPM_CLIENT_OK;
    case Refusal::unknown_asset:
    case Refusal::unknown_device:
      return failed(SPM_CLIENT_NOT_THERE, to_sentence(refusal));
    default:
      return failed(SPM_CLIENT_BAD_ARGUMENT, refusal, number);
  }
}

/// Puts a command into the ring. The calling thread must hold the client's mutex.
int put(spm_client& client, spm_shared_command& command) noexcept {
  spm_shared_ring& ring = client.connection().ring();
  if (client.head - load_acquire(ring.tail) >= SPM_RING_SLOTS) return failed(SPM_CLIENT_RING_FULL);
  command.sequence = client.head + 1;
  store_record(ring.slots[client.head % SPM_RING_SLOTS], command);
  store_release(ring.head, ++client.head);
  return SPM_CLIENT_OK;
}

int send(spm_client* client, spm_shared_command& command) {
  if (const int wrong = checked(*client, command); wrong != SPM_CLIENT_OK) return wrong;
  const std::lock_guard lock(client->mutex);
  return put(*client, command);
}

}  // namespace

int spm_client_add_object(spm_client* client, uint32_t asset, const spm_client_pose* pose,
                          double scale, const spm_client_material* material, uint64_t* object) {
  spm_shared_command command{};
  command.kind = SPM_COMMAND_ADD;
  command.index = asset;
  command.scale = scale;
  if (client == nullptr || object == nullptr || !read_pose(pose, command) ||
      (material != nullptr && !read_material(material, command))) {
    return failed(SPM_CLIENT_BAD_ARGUMENT);
  }
  *object = 0;
  if (const int wrong = checked(*client, command); wrong != SPM_CLIENT_OK) return wrong;
  const std::lock_guard lock(client->mutex);
  command.object =
      (std::uint64_t{client->connection().number()} << 32U) | (client->objects_added + 1);
  const int code = put(*client, command);
  if (code != SPM_CLIENT_OK) return code;
  ++client->objects_added;
  *object = command.object;
  return SPM_CLIENT_OK;
}

int spm_client_move_object(spm_client* client, uint64_t object, const spm_client_pose* pose) {
  spm_shared_command command{};
  command.kind = SPM_COMMAND_MOVE;
  command.object = object;
  if (client == nullptr || !read_pose(pose, command)) return failed(SPM_CLIENT_BAD_ARGUMENT);
  return send(client, command);
}

int spm_client_place_object(spm_client* client, uint64_t object, const spm_client_pose* pose) {
  spm_shared_command command{};
  command.kind = SPM_COMMAND_PLACE;
  command.object = object;
  if (client == nullptr || !read_pose(pose, command)) return failed(SPM_CLIENT_BAD_ARGUMENT);
  return send(client, command);
}

int spm_client_remove_object(spm_client* client, uint64_t object) {
  if (client == nullptr) return failed(SPM_CLIENT_BAD_ARGUMENT);
  spm_shared_command command{};
  command.kind = SPM_COMMAND_REMOVE;
  command.object = object;
  return send(client, command);
}

int spm_client_set_material(spm_client* client, uint64_t object,
                            const spm_client_material* material) {
  spm_shared_command command{};
  command.kind = SPM_COMMAND_MATERIAL;
  command.object = object;
  if (client == nullptr || !read_material(material, command))
    return failed(SPM_CLIENT_BAD_ARGUMENT);
  return send(client, command);
}

int spm_client_set_clutch(spm_client* client, uint32_t device, int on) {
  if (client == nullptr || (on != 0 && on != 1)) return failed(SPM_CLIENT_BAD_ARGUMENT);
  spm_shared_command command{};
  command.kind = SPM_COMMAND_CLUTCH;
  command.index = device;
  command.on = static_cast<std::uint32_t>(on);
  return send(client, command);
}

int spm_client_lead_hand(spm_client* client, uint32_t device, const spm_client_hand* hand) {
  if (client == nullptr || (hand != nullptr && hand->size < sizeof *hand)) {
    return failed(SPM_CLIENT_BAD_ARGUMENT);
  }
  spm_shared_command command{};
  command.kind = SPM_COMMAND_LEAD;
  command.index = device;
  command.on = hand != nullptr ? 1 : 0;
  if (hand != nullptr) {
    std::memcpy(command.position, hand->position, sizeof command.position);
    std::memcpy(command.orientation, hand->orientation, sizeof command.orientation);
    command.hold = hand->hold;
  }
  return send(client, command);
}

int spm_client_set_force_cap(spm_client* client, uint32_t device, double newtons) {
  if (client == nullptr) return failed(SPM_CLIENT_BAD_ARGUMENT);
  spm_shared_command command{};
  command.kind = SPM_COMMAND_FORCE_CAP;
  command.index = device;
  command.force_cap = newtons;
  return send(client, command);
}

int spm_client_set_method(spm_client* client, uint64_t object, uint32_t method) {
  if (client == nullptr || method > SPM_CLIENT_METHOD_PROXY) return failed(SPM_CLIENT_BAD_ARGUMENT);
  spm_shared_command command{};
  command.kind = SPM_COMMAND_METHOD;
  command.object = object;
  command.index = method;
  return send(client, command);
}

int spm_client_stabilize(spm_client* client, int on) {
  if (client == nullptr || (on != 0 && on != 1)) return failed(SPM_CLIENT_BAD_ARGUMENT);
  spm_shared_command command{};
  command.kind = SPM_COMMAND_STABILIZE;
  command.on = static_cast<std::uint32_t>(on);
  return send(client, command);
}

int spm_client_push_hand(spm_client* client, uint32_t device, const spm_client_push* push) {
  if (client == nullptr || push == nullptr || push->size < sizeof *push) {
    return failed(SPM_CLIENT_BAD_ARGUMENT);
  }
  spm_shared_command command{};
  command.kind = SPM_COMMAND_PUSH;
  command.index = device;
  std::memcpy(command.force, push->force, sizeof command.force);
  std::memcpy(command.torque, push->torque, sizeof command.torque);
  command.hold = push->hold;
  // Checked before it becomes an integer.
  if (!(push->hold > 0 && push->hold <= app_max_hold)) return failed(SPM_CLIENT_BAD_ARGUMENT);
  command.deadline_ns = monotonic_ns() + static_cast<std::int64_t>(push->hold * 1e9);
  return send(client, command);
}

int spm_client_set_effect(spm_client* client, uint32_t device, uint32_t number,
                          const spm_client_effect* effect) {
  if (client == nullptr || effect == nullptr || effect->size < sizeof *effect) {
    return failed(SPM_CLIENT_BAD_ARGUMENT);
  }
  spm_shared_command command{};
  command.kind = SPM_COMMAND_EFFECT;
  command.index = device;
  command.object = effect->object;
  command.effect = number;
  command.effect_kind = effect->kind;
  command.stiffness = effect->stiffness;
  command.damping = effect->damping;
  command.most_force = effect->most_force;
  command.range = effect->range;
  command.spacing = effect->spacing;
  std::memcpy(command.position, effect->point, sizeof command.position);
  std::memcpy(command.axis, effect->axis, sizeof command.axis);
  return send(client, command);
}

int spm_client_remove_effect(spm_client* client, uint32_t device, uint32_t number) {
  if (client == nullptr) return failed(SPM_CLIENT_BAD_ARGUMENT);
  spm_shared_command command{};
  command.kind = SPM_COMMAND_REMOVE_EFFECT;
  command.index = device;
  command.effect = number;
  return send(client, command);
}

int spm_client_acknowledge(spm_client* client, uint32_t device) {
  if (client == nullptr) return failed(SPM_CLIENT_BAD_ARGUMENT);
  spm_shared_command command{};
  command.kind = SPM_COMMAND_ACKNOWLEDGE;
  command.index = device;
  return send(client, command);
}

int spm_client_refusals(const spm_client* client, spm_client_command_counts* counts) {
  if (client == nullptr || counts == nullptr) return failed(SPM_CLIENT_BAD_ARGUMENT);
  const spm_shared_ring& ring = client->connection().ring();
  spm_client_command_counts found{};
  found.sent = load_relaxed(ring.head);
  found.taken = load_acquire(ring.tail);
  found.refused = load_acquire(ring.refused);
  found.last_refused = load_relaxed(ring.last_refused);
  found.last_refusal = static_cast<std::uint32_t>(load_relaxed(ring.last_refusal));
  return give(counts, found);
}
