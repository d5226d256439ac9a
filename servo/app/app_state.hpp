// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/hand_pose.hpp"
#include "common/base/placement.hpp"
#include "servo/app/app_loop.hpp"
#include "servo/app/client_ring.hpp"
#include "servo/app/shared_memory.hpp"
#include "servo/devices/base/device.hpp"
#include "servo/force/placed_contact.hpp"
#include "servo/force/tool_settings.hpp"
#include "servo/safety/safety.hpp"
#include "servo/shared/app_command.hpp"

namespace spm::servo {

/// One device in a tick, as applications see it; world frame.
struct AppDevice {
  DeviceState state;
  DeviceHealth health = DeviceHealth::ok;
  Vector3 velocity = Vector3::Zero();          ///< m/s
  Wrench wrench;                               ///< as sent
  Vector3 angular_velocity = Vector3::Zero();  ///< rad/s
  HandPose proxy;                              ///< where the surface holds the hand
  double force_cap = 0;                        ///< N, that holds now; infinity: none
  double torque_cap = 0;                       ///< N m, the same; 0: the device gives none
  double depth = 0;                            ///< m
  bool contact = false;
  ForceOff cause = ForceOff::none;
  bool force_capped = false, torque_capped = false;  ///< what was sent met its cap
  bool tool_capped = false;                          ///< the coupling of hand and tool met its cap
  bool leadable = false;                             ///< applications may lead its hand
  bool led = false;                                  ///< one does
  bool has_tool = false;
  HandPose tool;             ///< of the tool that the hand holds
  std::uint32_t level = 0;   ///< of its samples, coarser than the finest
  std::uint32_t culled = 0;  ///< objects that were found apart from it as a whole
  /// where it touches; objects by their numbers in the forces. At most SPM_MAX_CONTACTS are told.
  std::span<const ContactPatch> patches;
};

/// One object in a tick, as applications see it; world frame.
struct AppObject {
  std::uint64_t id = 0;
  std::uint32_t asset = 0;
  Placement pose;
  Wrench reaction;    ///< on the object, about its origin
  double silent = 0;  ///< s since the last pose from an application
  bool movable = false;
  bool contact = false;
  bool driven = false;                     ///< an application has given it a pose
  const PlacedObject* settings = nullptr;  ///< how it feels; null: not told
  bool stabilized = false;                 ///< its scene is
};

/// What applications learn of a tick. At most SPM_MAX_DEVICES and SPM_MAX_OBJECTS are published.
struct AppTick {
  std::uint64_t tick = 0;
  std::int64_t time_ns = 0;  ///< of CLOCK_MONOTONIC
  std::span<const AppDevice> devices;
  std::span<const AppObject> objects;
  std::span<const std::uint64_t> ids{};  ///< of the objects, by their numbers in the forces
  std::size_t object_total = 0;          ///< of the scene, with those that are not published
};

/// The names of things; longer ones are cut.
struct AppNames {
  std::vector<std::string> devices;
  std::vector<std::string> assets;
  std::vector<std::string> objects;        ///< the scene's, with the ids 0, 1, ...
  std::vector<std::string> asset_paths{};  ///< absolute, of the assets
  /// N/m of the scene, at which each device begins to shake; 0: not known
  std::vector<double> bare_borders{}, stabilized_borders{};
};

struct AppClientReport;

/// Counts of the commands so far.
struct AppCounters {
  std::uint64_t taken = 0;    ///< commands passed to the loop
  std::uint64_t refused = 0;  ///< commands that were not followed
  std::uint64_t garbage = 0;  ///< heads and sequence numbers that made no sense
};

/// The loop's side of the memory that it shares with applications. It publishes what a tick did,
/// and takes their commands. Construction allocates. `publish`, `count`, `take` and `refuse` belong
/// to the loop's thread: they allocate nothing, take no lock, make no system call, and take no
/// longer whatever an application does.
class AppState {
 public:
  /// Places in rings that one tick looks at: of one client, and of all.
  static constexpr std::size_t max_of_client = 16;
  static constexpr std::size_t max_of_all = 32;

  /// Errors: file_or_device, if there is no memory.
  [[nodiscard]] static Result<std::unique_ptr<AppState>> create(double rate_hz,
                                                                const AppNames& names);
  AppState(const AppState&) = delete;
  AppState& operator=(const AppState&) = delete;
  /// Tells applications that the daemon has ended.
  ~AppState();

  /// Loop: publishes a tick. Readers never see two ticks mixed.
  void publish(const AppTick& tick) noexcept;

  /// Loop: counts a tick that is over. It is separate from `publish`, because a tick that publishes
  /// is not over.
  void count(const AppLoop& loop) noexcept;

  /// Loop: the valid commands that are due now, oldest first for each client, and the departures of
  /// clients that are gone. If there are more than a tick takes, the clients take turns. Valid
  /// until the next call.
  [[nodiscard]] std::span<const AppCommand> take(std::int64_t now_ns) noexcept;

  /// Loop: how long before the last `take` a client gave a sign of life, s. `connection` is the
  /// client's; 0 if it is not connected.
  [[nodiscard]] double silence(std::uint32_t connection) const noexcept;

  /// Loop: tells the application that one of the commands taken last could not be followed.
  void refuse(const AppCommand& command, Refusal refusal) noexcept;

  /// Any one thread beside the loop: sets new names, after a scene was exchanged.
  void rename(const AppNames& names);

  /// Server: tells applications that the daemon ends in order.
  void end() noexcept;
  /// Server, one thread: publishes who is connected; at most SPM_MAX_CLIENTS.
  void tell_clients(std::span<const AppClientReport> clients) noexcept;
  /// Server: the places for clients' rings.
  [[nodiscard]] std::array<ClientRing, SPM_MAX_CLIENTS>& rings() noexcept { return rings_; }
  /// Server: the memory that clients map.
  [[nodiscard]] const SharedMemory& memory() const noexcept { return memory_; }

  /// Any thread.
  [[nodiscard]] AppCounters counters() const noexcept;

 private:
  explicit AppState(SharedMemory memory) noexcept;
  [[nodiscard]] spm_shared_state& shared() const noexcept {
    return *static_cast<spm_shared_state*>(memory_.data());
  }
  [[nodiscard]] spm_shared_device packed(std::size_t index, const AppDevice& device) noexcept;
  std::size_t take_from(std::uint32_t client, std::size_t max_count,
                        const AppCommandLimits& limits) noexcept;
  void meet(std::uint32_t client) noexcept;
  void keep_or_refuse(ClientRing& ring, const spm_shared_command& command, std::uint32_t client,
                      const AppCommandLimits& limits) noexcept;

  /// The last published state of a device, to count how often it changed.
  struct Seen {
    bool contact = false;
    bool cut = true;
    std::uint32_t contacts = 0, cuts = 0;
    std::uint32_t last_cause = 0;
  };

  /// When a client last gave a sign of life.
  struct Alive {
    std::uint32_t connection = 0;
    std::uint64_t sign = 0;
    std::int64_t at_ns = 0;
  };

  SharedMemory memory_;
  std::array<ClientRing, SPM_MAX_CLIENTS> rings_;
  std::array<Alive, SPM_MAX_CLIENTS> alive_;
  std::int64_t now_ns_ = 0;  ///< of the last `take`
  std::array<Seen, SPM_MAX_DEVICES> seen_;
  std::array<AppCommand, max_of_all + SPM_MAX_CLIENTS> taken_;  ///< and departures
  std::size_t taken_count_ = 0;
  std::uint32_t first_client_ = 0;  ///< whose turn is first
  std::atomic<std::uint32_t> devices_{0}, assets_{0};
  std::atomic<std::uint64_t> taken_total_{0}, refused_total_{0}, garbage_total_{0};
};

}  // namespace spm::servo
