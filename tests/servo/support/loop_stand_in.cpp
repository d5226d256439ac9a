// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/support/loop_stand_in.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "servo/base/clock.hpp"
#include "servo/shared/shared_words.hpp"

namespace spm::test {

using namespace servo;

namespace {

constexpr std::int64_t tick_ns = 1'000'000;

Vector3 vector_of(double start) { return {start, start + 0.25, start + 0.5}; }

bool is_vector_of(const double (&vector)[3], double start) {
  return vector[0] == start && vector[1] == start + 0.25 && vector[2] == start + 0.5;
}

SharedMemory memory_or_throw() {
  auto memory = SharedMemory::create("spm-test-ring", sizeof(spm_shared_ring));
  if (!memory) throw std::runtime_error(memory.error().message);
  return std::move(*memory);
}

}  // namespace

AppDevice device_of(std::uint64_t tick) {
  const auto start = static_cast<double>(tick);
  AppDevice device;
  device.state.position = vector_of(start);
  device.state.orientation = Eigen::Quaterniond(start, start + 1, start + 2, start + 3);
  device.state.buttons = static_cast<std::uint32_t>(tick);
  device.velocity = vector_of(start + 10);
  device.wrench = {vector_of(start + 20), vector_of(start + 30)};
  device.depth = start + 40;
  device.proxy = {vector_of(start + 80), Eigen::Quaterniond(start + 81, start, start, start)};
  device.force_cap = start + 90;
  device.torque_cap = start + 91;
  device.angular_velocity = vector_of(start + 100);
  device.tool = {vector_of(start + 110), Eigen::Quaterniond(start + 120, start, start, start)};
  device.has_tool = true;
  device.torque_capped = tick % 2 == 0;
  device.level = static_cast<std::uint32_t>(tick % 4);
  device.contact = tick % 2 == 1;
  device.cause = tick % 3 == 0 ? ForceOff::device_silent : ForceOff::none;
  device.health = tick % 3 == 0 ? DeviceHealth::silent : DeviceHealth::ok;
  return device;
}

bool is_of_tick(const spm_shared_device& device, std::uint64_t tick) {
  const auto start = static_cast<double>(tick);
  const std::uint32_t cause = tick % 3 == 0 ? static_cast<std::uint32_t>(ForceOff::device_silent)
                                            : static_cast<std::uint32_t>(ForceOff::none);
  return is_vector_of(device.position, start) && device.orientation[0] == start &&
         device.orientation[3] == start + 3 && is_vector_of(device.velocity, start + 10) &&
         is_vector_of(device.force, start + 20) && is_vector_of(device.torque, start + 30) &&
         device.depth == start + 40 && is_vector_of(device.proxy, start + 80) &&
         device.force_cap == start + 90 && device.torque_cap == start + 91 &&
         is_vector_of(device.angular_velocity, start + 100) &&
         is_vector_of(device.tool_position, start + 110) &&
         device.tool_orientation[0] == start + 120 && device.proxy_orientation[0] == start + 81 &&
         device.level == tick % 4 && (device.flags & SPM_DEVICE_TOOL) != 0 &&
         ((device.flags & SPM_DEVICE_TORQUE_CAPPED) != 0) == (tick % 2 == 0) &&
         device.buttons == static_cast<std::uint32_t>(tick) && device.cause == cause &&
         ((device.flags & SPM_DEVICE_CONTACT) != 0) == (tick % 2 == 1);
}

AppObject object_of(std::uint64_t id, std::uint64_t tick) {
  const auto start = static_cast<double>(tick + id);
  AppObject object;
  object.id = id;
  object.pose.position = vector_of(start);
  object.pose.rotation = Eigen::Quaterniond(start, start + 1, start + 2, start + 3);
  object.pose.scale = start + 4;
  object.reaction = {vector_of(start + 50), vector_of(start + 60)};
  object.silent = start + 70;
  object.asset = static_cast<std::uint32_t>(tick);
  object.movable = tick % 2 == 1;
  return object;
}

bool is_of_tick(const spm_shared_object& object, std::uint64_t tick) {
  const auto start = static_cast<double>(tick + object.id);
  return is_vector_of(object.position, start) && object.orientation[1] == start + 1 &&
         object.scale == start + 4 && is_vector_of(object.force, start + 50) &&
         is_vector_of(object.torque, start + 60) && object.silent == start + 70 &&
         object.asset == static_cast<std::uint32_t>(tick) &&
         ((object.flags & SPM_OBJECT_MOVABLE) != 0) == (tick % 2 == 1);
}

std::unique_ptr<AppState> small_state() {
  auto state = AppState::create(
      1000, {{"hand"}, {"bunny"}, {"first"}, {"/models/bunny.spm.exr"}, {900}, {1800}});
  if (!state) throw std::runtime_error(state.error().message);
  return std::move(*state);
}

SocketFolder::SocketFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "spm-socket-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for sockets");
  folder_ = name;
}

SocketFolder::~SocketFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

RawRing::RawRing(std::uint32_t connection)
    : memory_(memory_or_throw()),
      attached_{static_cast<spm_shared_ring*>(memory_.data()), connection} {}

void RawRing::write(spm_shared_command command) {
  command.sequence = head_ + 1;
  store_record(ring().slots[head_ % SPM_RING_SLOTS], command);
  store_release(ring().head, ++head_);
}

spm_shared_command move_command(std::uint64_t object, double x) {
  spm_shared_command command{};
  command.kind = SPM_COMMAND_MOVE;
  command.object = object;
  command.position[0] = x;
  command.orientation[0] = 1;
  return command;
}

LoopStandIn::LoopStandIn(AppState& state) : state_(state) {
  AppObject first;
  first.movable = true;
  felt_.force.stiffness = 750;
  felt_.effects.friction = {0.5, 0.4};
  felt_.effects.texture.seed = 3;
  first.settings = &felt_;
  first.stabilized = true;
  hands_.know_device(0, true);
  objects_.push_back(first);
  objects_.reserve(SPM_MAX_OBJECTS);
  thread_ = std::thread([this] { run(); });
}

LoopStandIn::~LoopStandIn() {
  stop_.store(true);
  thread_.join();
}

void LoopStandIn::run() {
  std::int64_t due = now_ns();
  std::uint64_t contact_ticks = 0;
  for (std::uint64_t tick = 0; !stop_.load(); ++tick) {
    sleep_until(due);
    due = std::max(due + tick_ns, now_ns());
    for (const AppCommand& command : state_.take(now_ns())) follow(command);
    std::array<AppDevice, 1> devices;
    devices[0].state.position = {static_cast<double>(tick) * 1e-6, 0, 0};
    devices[0].state.buttons = buttons_.load();
    devices[0].contact = contact_.load();
    devices[0].cause = cause_.load();
    devices[0].leadable = true;
    devices[0].led = hands_.of(0, now_ns()) != nullptr;
    devices[0].has_tool = true;
    devices[0].tool.position = {0.5, 0.25, static_cast<double>(tick) * 1e-6};
    devices[0].tool.orientation = Eigen::Quaterniond(0, 1, 0, 0);
    // Pressed at two places while it is in contact.
    const std::array<ContactPatch, 2> patches{
        ContactPatch{{0.1, 0.2, 0.3}, Vector3::UnitY(), {0, 2, 0}, 1e-3, 0},
        ContactPatch{{0.4, 0.5, 0.6}, Vector3::UnitX(), {1, 0, 0}, 5e-4, 1}};
    if (devices[0].contact) devices[0].patches = patches;
    const std::array<std::uint64_t, 2> ids{0, 7};
    state_.publish({tick, now_ns(), devices, objects_, ids});
    contact_ticks += devices[0].contact ? 1 : 0;
    count(tick + 1, contact_ticks);
    ticks_.fetch_add(1);
  }
}

/// Numbers that a reader can tell from each other.
void LoopStandIn::count(std::uint64_t ticks, std::uint64_t contact_ticks) {
  const std::array<DeviceCounters, 1> devices{{{contact_ticks, 12, 13, 1.5, 2.5, 3.5, {}}}};
  state_.count(
      {now_ns(), stand_in_wake_ns, stand_in_busy_ns, ticks, ticks + 7, ticks + 8, devices});
}

void LoopStandIn::follow(const AppCommand& command) {
  const Refusal refusal = apply(command);
  if (refusal != Refusal::none) state_.refuse(command, refusal);
}

Refusal LoopStandIn::apply(const AppCommand& command) {
  if (command.action == AppAction::departure) {
    std::erase_if(objects_,
                  [&](const AppObject& object) { return object.id >> 32U == command.connection; });
    hands_.leave(command.connection);
    departures_.fetch_add(1);
    return Refusal::none;
  }
  if (command.action == AppAction::lead) return hands_.lead(command, now_ns());
  if (command.action == AppAction::acknowledge) set_cause(ForceOff::none);
  switch (command.action) {
    case AppAction::clutch:
    case AppAction::force_cap:
    case AppAction::acknowledge:
    case AppAction::push:
    case AppAction::effect:
    case AppAction::stabilize:
    case AppAction::remove_effect:
      return Refusal::none;
    default:
      break;
  }
  const auto found = std::find_if(objects_.begin(), objects_.end(), [&](const AppObject& object) {
    return object.id == command.object;
  });
  if (command.action == AppAction::add) {
    if (objects_.size() == SPM_MAX_OBJECTS) return Refusal::too_many_objects;
    AppObject object;
    object.id = command.object;
    object.asset = command.index;
    object.pose = command.pose;
    object.movable = true;
    objects_.push_back(object);
    return Refusal::none;
  }
  if (found == objects_.end()) return Refusal::unknown_object;
  if (command.action == AppAction::remove) {
    objects_.erase(found);
  } else if (command.action == AppAction::move) {
    found->pose = command.pose;
    found->driven = true;
  }
  return Refusal::none;
}

}  // namespace spm::test
