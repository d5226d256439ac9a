// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <utility>

#include "servo/client/connection.hpp"
#include "servo/client/event_queue.hpp"
#include "servo/client/spm_client.h"
#include "servo/client/state_reader.hpp"
#include "servo/shared/shared_words.hpp"

/// What the handle of spm_client.h refers to.
struct spm_client {
  explicit spm_client(spm::servo::Connection opened) : connection(std::move(opened)) {}

  spm::servo::Connection connection;
  /// the texts of the daemon, closed by zeros
  std::array<spm_shared_cause, SPM_MAX_CAUSES> causes{};
  std::uint32_t cause_count = 0;

  std::mutex mutex;                 ///< guards the members below; the daemon does not take it
  std::uint64_t head = 0;           ///< commands written so far
  std::uint32_t objects_added = 0;  ///< lower half of the next object's id
  spm::servo::EventQueue events;
};

namespace spm::servo {

/// The daemon's state, for reading. The call also tells the daemon that the application is alive.
[[nodiscard]] inline const spm_shared_state& look(const spm_client& client) noexcept {
  std::uint64_t& calls = client.connection.ring().calls;
  // If two threads at once count one call, that is enough: the number only has to change.
  store_relaxed(calls, load_relaxed(calls) + 1);
  return client.connection.state();
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
