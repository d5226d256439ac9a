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
#include "servo/shared/shared_words.hpp"
#include "servo/client/spm_client.h"

/// What spm_client.h's handle stands for.
struct spm_client {
  explicit spm_client(spm::servo::Connection opened) : connection(std::move(opened)) {}

  spm::servo::Connection connection;
  std::array<spm_shared_cause, SPM_MOST_CAUSES> causes{};  ///< the daemon's words, closed by zeros
  std::uint32_t cause_count = 0;

  std::mutex mutex;                 ///< guards what follows; the daemon has no part in it
  std::uint64_t head = 0;           ///< commands written so far
  std::uint32_t objects_added = 0;  ///< lower half of the next object's id
  spm::servo::EventQueue events;
};

namespace spm::servo {

/// The daemon's state, for a look at it; the daemon learns that the application is alive.
[[nodiscard]] inline const spm_shared_state& look(const spm_client& client) noexcept {
  std::uint64_t& calls = client.connection.ring().calls;
  // Two threads at once may count one call: the daemon only needs it to change.
  store_relaxed(calls, load_relaxed(calls) + 1);
  return client.connection.state();
}

/// Copies a result into a caller's struct, as much of it as the caller's version has. `Record`
/// begins with its size, which is what all versions have had at least.
template <class Record>
[[nodiscard]] int give(Record* to, const Record& from) noexcept {
  const std::uint32_t size = to->size;
  if (size < sizeof(Record)) return SPM_CLIENT_BAD_ARGUMENT;
  std::memcpy(to, &from, sizeof(Record));
  to->size = size;
  return SPM_CLIENT_OK;
}

}  // namespace spm::servo
