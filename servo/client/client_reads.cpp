// SPDX-License-Identifier: Apache-2.0
// Reading of spm_client.h: snapshots of the newest tick, and copies of them for the caller.
#include <algorithm>
#include <array>
#include <cstring>

#include "servo/client/client.hpp"
#include "servo/client/state_reader.hpp"

namespace {

using namespace spm::servo;

template <std::size_t Count>
void copy_to(double (&to)[Count], const double (&from)[Count]) noexcept {
  std::memcpy(to, from, sizeof to);
}

std::uint32_t limits_of(std::uint32_t flags) noexcept {
  std::uint32_t met = 0;
  if ((flags & SPM_DEVICE_FORCE_CAPPED) != 0) met |= SPM_CLIENT_FORCE_CAP_MET;
  if ((flags & SPM_DEVICE_TORQUE_CAPPED) != 0) met |= SPM_CLIENT_TORQUE_CAP_MET;
  if ((flags & SPM_DEVICE_TOOL_CAPPED) != 0) met |= SPM_CLIENT_TOOL_CAP_MET;
  return met;
}

std::uint32_t hand_of(std::uint32_t flags) noexcept {
  if ((flags & SPM_DEVICE_LEADABLE) == 0) return SPM_CLIENT_HAND_OWN;
  return (flags & SPM_DEVICE_LED) != 0 ? SPM_CLIENT_HAND_LED : SPM_CLIENT_HAND_FREE;
}

spm_client_contact public_contact(const spm_shared_contact& from, std::uint32_t device) noexcept {
  spm_client_contact to{};
  to.device = device;
  to.object = from.object;
  copy_to(to.place, from.place);
  copy_to(to.normal, from.normal);
  copy_to(to.force, from.force);
  to.depth = from.depth;
  return to;
}

spm_client_device public_device(const spm_shared_device& from, std::uint64_t tick) noexcept {
  spm_client_device to{};
  to.connected = (from.flags & SPM_DEVICE_CONNECTED) != 0 ? 1 : 0;
  to.tick = tick;
  copy_to(to.position, from.position);
  copy_to(to.orientation, from.orientation);
  copy_to(to.velocity, from.velocity);
  copy_to(to.force, from.force);
  copy_to(to.torque, from.torque);
  to.depth = from.depth;
  to.contact = (from.flags & SPM_DEVICE_CONTACT) != 0 ? 1 : 0;
  to.buttons = from.buttons;
  to.cause = from.cause;
  to.health = from.health;
  to.contacts = from.contacts;
  to.cuts = from.cuts;
  copy_to(to.proxy, from.proxy);
  to.force_cap = from.force_cap;
  copy_to(to.angular_velocity, from.angular_velocity);
  to.torque_cap = from.torque_cap;
  to.limits = limits_of(from.flags);
  to.has_tool = (from.flags & SPM_DEVICE_TOOL) != 0 ? 1 : 0;
  to.contact_count = from.contact_count;
  to.level = from.level;
  to.culled = from.culled;
  to.hand = hand_of(from.flags);
  copy_to(to.tool_position, from.tool_position);
  copy_to(to.tool_orientation, from.tool_orientation);
  copy_to(to.proxy_orientation, from.proxy_orientation);
  return to;
}

spm_client_object public_object(const spm_shared_object& from, std::uint64_t tick) noexcept {
  spm_client_object to{};
  to.asset = from.asset;
  to.id = from.id;
  to.tick = tick;
  copy_to(to.position, from.position);
  copy_to(to.orientation, from.orientation);
  to.scale = from.scale;
  copy_to(to.force, from.force);
  copy_to(to.torque, from.torque);
  to.silent = from.silent;
  to.movable = (from.flags & SPM_OBJECT_MOVABLE) != 0 ? 1 : 0;
  to.contact = (from.flags & SPM_OBJECT_CONTACT) != 0 ? 1 : 0;
  to.driven = (from.flags & SPM_OBJECT_DRIVEN) != 0 ? 1 : 0;
  return to;
}

spm_client_tick public_tick(const spm_shared_snapshot& from) noexcept {
  spm_client_tick to{};
  to.tick = load_relaxed(from.tick);
  to.time_ns = load_relaxed(from.time_ns);
  to.device_count = device_count(from);
  to.object_count = object_count(from);
  to.object_total = static_cast<std::uint32_t>(load_relaxed(from.object_total));
  return to;
}

/// Fills an array of a caller whose struct may be longer than ours.
template <class Record>
void give_at(Record* first, std::size_t index, const Record& from) noexcept {
  const std::uint32_t size = first->size;
  Record record = from;
  record.size = size;
  std::memcpy(reinterpret_cast<unsigned char*>(first) + index * size, &record,
              std::min<std::size_t>(size, sizeof record));
}

}  // namespace

int spm_client_read_tick(const spm_client* client, spm_client_tick* tick) {
  if (client == nullptr || tick == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  spm_client_tick found{};
  const int result = read_tick(*client, [&](const auto& snapshot) {
    found = public_tick(snapshot);
    return true;
  });
  return result == SPM_CLIENT_OK ? give(tick, found) : result;
}

int spm_client_read_device(const spm_client* client, uint32_t device, spm_client_device* state) {
  if (client == nullptr || state == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  spm_shared_device found;
  std::uint64_t tick = 0;
  const int result = read_tick(*client, [&](const auto& snapshot) {
    if (device >= device_count(snapshot)) return false;
    tick = load_relaxed(snapshot.tick);
    found = load_record(snapshot.devices[device]);
    return true;
  });
  return result == SPM_CLIENT_OK ? give(state, public_device(found, tick)) : result;
}

int spm_client_read_object(const spm_client* client, uint64_t object, spm_client_object* state) {
  if (client == nullptr || state == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  spm_shared_object found;
  std::uint64_t tick = 0;
  const int result = read_tick(*client, [&](const auto& snapshot) {
    tick = load_relaxed(snapshot.tick);
    for (std::uint32_t i = 0; i < object_count(snapshot); ++i) {
      if (load_relaxed(snapshot.objects[i].id) != object) continue;
      found = load_record(snapshot.objects[i]);
      return true;
    }
    return false;
  });
  return result == SPM_CLIENT_OK ? give(state, public_object(found, tick)) : result;
}

int spm_client_read_contacts(const spm_client* client, uint32_t device, spm_client_tick* tick,
                             spm_client_contact* contacts, size_t max, size_t* count) {
  if (client == nullptr || count == nullptr || (tick != nullptr && tick->size < sizeof *tick) ||
      (max > 0 && (contacts == nullptr || contacts->size < sizeof *contacts))) {
    return SPM_CLIENT_BAD_ARGUMENT;
  }
  *count = 0;
  spm_client_tick found{};
  std::array<spm_shared_contact, SPM_MAX_CONTACTS> seen;
  std::size_t touching = 0;
  const int result = read_tick(*client, [&](const auto& snapshot) {
    if (device >= device_count(snapshot)) return false;
    found = public_tick(snapshot);
    touching = std::min<std::size_t>(load_record(snapshot.devices[device]).contact_count,
                                     std::min<std::size_t>(max, SPM_MAX_CONTACTS));
    load_words(seen.data(), snapshot.contacts[device], touching * sizeof(spm_shared_contact));
    return true;
  });
  if (result != SPM_CLIENT_OK) return result;
  for (std::size_t i = 0; i < touching; ++i) give_at(contacts, i, public_contact(seen[i], device));
  *count = touching;
  return tick != nullptr ? give(tick, found) : SPM_CLIENT_OK;
}

int spm_client_read_all(const spm_client* client, spm_client_tick* tick, spm_client_device* devices,
                        size_t max_devices, spm_client_object* objects, size_t max_objects) {
  if (client == nullptr || tick == nullptr || tick->size < sizeof *tick ||
      (max_devices > 0 && (devices == nullptr || devices->size < first_size<spm_client_device>)) ||
      (max_objects > 0 && (objects == nullptr || objects->size < sizeof *objects))) {
    return SPM_CLIENT_BAD_ARGUMENT;
  }
  spm_client_tick found{};
  std::array<spm_shared_device, SPM_MAX_DEVICES> found_devices;
  std::array<spm_shared_object, SPM_MAX_OBJECTS> found_objects;
  std::size_t devices_read = 0, objects_read = 0;
  const int result = read_tick(*client, [&](const auto& snapshot) {
    found = public_tick(snapshot);
    devices_read = std::min<std::size_t>(found.device_count, max_devices);
    objects_read = std::min<std::size_t>(found.object_count, max_objects);
    load_words(found_devices.data(), snapshot.devices, devices_read * sizeof(spm_shared_device));
    load_words(found_objects.data(), snapshot.objects, objects_read * sizeof(spm_shared_object));
    return true;
  });
  if (result != SPM_CLIENT_OK) return result;
  for (std::size_t i = 0; i < devices_read; ++i) {
    give_at(devices, i, public_device(found_devices[i], found.tick));
  }
  for (std::size_t i = 0; i < objects_read; ++i) {
    give_at(objects, i, public_object(found_objects[i], found.tick));
  }
  return give(tick, found);
}
