// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "servo/base/clock.hpp"
#include "servo/client/connection.hpp"
#include "servo/client/event_queue.hpp"
#include "servo/client/spm_client.h"
#include "servo/client/state_reader.hpp"
#include "servo/shared/shared_words.hpp"

/// What the handle of spm_client.h refers to.
struct spm_client {
  spm_client(spm::servo::Connection opened, spm::servo::ConnectionRequest asked, bool again)
      : request(std::move(asked)), reconnects(again) {
    take(std::move(opened));
  }

  /// The connection that is used now.
  [[nodiscard]] const spm::servo::Connection& connection() const noexcept {
    return *current.load(std::memory_order_acquire);
  }
  /// Uses another connection from now on. Threads may still read from the old ones.
  void take(spm::servo::Connection opened) {
    connections.push_back(std::make_unique<spm::servo::Connection>(std::move(opened)));
    current.store(connections.back().get(), std::memory_order_release);
  }

  spm::servo::ConnectionRequest request;
  bool reconnects;  ///< by itself
  std::atomic<const spm::servo::Connection*> current{nullptr};
  /// the texts of the daemon, closed by zeros
  std::array<spm_shared_cause, SPM_MAX_CAUSES> causes{};
  std::uint32_t cause_count = 0;

  std::mutex mutex;  ///< guards the members below; the daemon does not take it
  std::vector<std::unique_ptr<spm::servo::Connection>> connections;
  std::int64_t tried_ns = 0;        ///< when a connection was last tried
  bool loss_told = false;           ///< by an event
  bool found = false;               ///< again; to be told by an event
  std::uint64_t head = 0;           ///< commands written so far
  std::uint32_t objects_added = 0;  ///< lower half of the next object's id
  spm::servo::EventQueue events;
};

namespace spm::servo {

/// The daemon's state, for reading. The call also tells the daemon that the application is alive.
[[nodiscard]] inline const spm_shared_state& look(const spm_client& client) noexcept {
  const Connection& connection = client.connection();
  std::uint64_t& calls = connection.ring().calls;
  // If two threads at once count one call, that is enough: the number only has to change.
  store_relaxed(calls, load_relaxed(calls) + 1);
  return connection.state();
}

/// Whether the daemon ended or was killed. A loop that ticks is there; only where it does not, the
/// socket is asked, by a system call.
[[nodiscard]] inline bool is_gone(const Connection& connection) noexcept {
  constexpr std::int64_t fresh_ns = 3'000'000;
  const spm_shared_state& state = connection.state();
  if (load_acquire(state.ended) != 0) return true;
  const std::int64_t beat = load_relaxed(state.heartbeat_ns), now = now_ns();
  const bool fresh = beat <= now && beat > now - fresh_ns;
  return !fresh && !connection.daemon_is_there();
}

/// Finds the daemon again, if it is gone, the client does so by itself, and it was not tried just
/// now. SPM_CLIENT_OK where there is one.
[[nodiscard]] int find_again(const spm_client& client) noexcept;

/// SPM_CLIENT_OK where there is a daemon, else SPM_CLIENT_NO_DAEMON.
[[nodiscard]] inline int there(const spm_client& client) noexcept {
  return is_gone(client.connection()) ? find_again(client) : SPM_CLIENT_OK;
}

/// What a function of the library returns for a reading.
[[nodiscard]] inline int code_of(ReadResult result) noexcept {
  switch (result) {
    case ReadResult::fine:
      return SPM_CLIENT_OK;
    case ReadResult::busy:
      return SPM_CLIENT_BUSY;
    case ReadResult::none:
      return SPM_CLIENT_NOT_THERE;
  }
  return SPM_CLIENT_INTERNAL;
}

/// Reads the newest tick by `read(snapshot)`, as read_newest.
template <class Read>
[[nodiscard]] int read_tick(const spm_client& client, const Read& read) noexcept {
  if (const int code = there(client); code != SPM_CLIENT_OK) return code;
  return code_of(read_newest(look(client), read));
}

/// The size of a struct's first version, which its callers may still have.
template <class Record>
inline constexpr std::size_t first_size = sizeof(Record);
template <>
inline constexpr std::size_t first_size<spm_client_device> = offsetof(spm_client_device, proxy);

template <>
inline constexpr std::size_t first_size<spm_client_device_counts> =
    offsetof(spm_client_device_counts, torque_cap_hits);
template <>
inline constexpr std::size_t first_size<spm_client_loop> = offsetof(spm_client_loop, degraded);

/// Copies a result into a caller's struct, as far as the caller's version of the struct goes.
/// `Record` begins with its size; all versions have had at least that.
template <class Record>
[[nodiscard]] int give(Record* to, const Record& from) noexcept {
  const std::uint32_t size = to->size;
  if (size < first_size<Record>) return SPM_CLIENT_BAD_ARGUMENT;
  std::memcpy(to, &from, std::min<std::size_t>(size, sizeof(Record)));
  to->size = size;
  return SPM_CLIENT_OK;
}

}  // namespace spm::servo
