// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "servo/app/app_hands.hpp"
#include "servo/app/app_state.hpp"

namespace spm::test {

/// A device whose numbers all follow from the tick, so that a state mixed from two ticks shows.
[[nodiscard]] servo::AppDevice device_of(std::uint64_t tick);

/// Whether every number of a device, as shared, belongs to one tick.
[[nodiscard]] bool is_of_tick(const spm_shared_device& device, std::uint64_t tick);

/// An object whose numbers all follow from the tick.
[[nodiscard]] servo::AppObject object_of(std::uint64_t id, std::uint64_t tick);
[[nodiscard]] bool is_of_tick(const spm_shared_object& object, std::uint64_t tick);

/// A state of one device, one asset and one object, named "hand", "bunny" and "first".
[[nodiscard]] std::unique_ptr<servo::AppState> small_state();

/// A folder of its own for sockets, removed at the end.
class SocketFolder {
 public:
  SocketFolder();
  SocketFolder(const SocketFolder&) = delete;
  SocketFolder& operator=(const SocketFolder&) = delete;
  ~SocketFolder();
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
  [[nodiscard]] const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

/// A ring that a test writes as a client would, correctly or not, without a socket.
class RawRing {
 public:
  explicit RawRing(std::uint32_t connection);
  [[nodiscard]] const servo::AttachedRing* attached() const { return &attached_; }
  [[nodiscard]] spm_shared_ring& ring() const { return *attached_.ring; }
  /// Writes a command with the sequence number that is due.
  void write(spm_shared_command command);

 private:
  servo::SharedMemory memory_;
  servo::AttachedRing attached_;
  std::uint64_t head_ = 0;
};

/// A command to move an object to x metres, with a pose that may be sent.
[[nodiscard]] spm_shared_command move_command(std::uint64_t object, double x);

/// How late each tick of the stand-in is reported to begin, and how long it is reported to work.
inline constexpr std::int64_t stand_in_wake_ns = 200, stand_in_busy_ns = 500;

/// A thread in the place of the loop: it publishes 1000 ticks a second, moves the object along x by
/// what it is told, and does what commands say as far as an application can see it.
class LoopStandIn {
 public:
  explicit LoopStandIn(servo::AppState& state);
  LoopStandIn(const LoopStandIn&) = delete;
  LoopStandIn& operator=(const LoopStandIn&) = delete;
  ~LoopStandIn();

  [[nodiscard]] std::uint64_t ticks() const { return ticks_.load(); }
  [[nodiscard]] std::uint64_t departures() const { return departures_.load(); }
  /// Makes the device be in contact, press buttons, or have no force, from the next tick on.
  void set_contact(bool on) { contact_.store(on); }
  void set_buttons(std::uint32_t buttons) { buttons_.store(buttons); }
  void set_cause(servo::ForceOff cause) { cause_.store(cause); }

 private:
  void run();
  void count(std::uint64_t ticks, std::uint64_t contact_ticks);
  void follow(const servo::AppCommand& command);
  [[nodiscard]] servo::Refusal apply(const servo::AppCommand& command);

  servo::AppState& state_;
  servo::AppHands hands_;
  PlacedObject felt_;  ///< how the first object feels
  std::vector<servo::AppObject> objects_;
  std::atomic<std::uint64_t> ticks_{0}, departures_{0};
  std::atomic<bool> stop_{false}, contact_{false};
  std::atomic<std::uint32_t> buttons_{0};
  std::atomic<servo::ForceOff> cause_{servo::ForceOff::none};
  std::thread thread_;
};

}  // namespace spm::test
