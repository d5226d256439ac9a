// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "servo/shared/shared_layout.h"
#include "servo/shared/shared_words.hpp"

namespace spm::servo {

enum class ReadResult : std::uint8_t { fine, busy, none };

/// How often a reader tries at most. A try fails only if it took longer than a tick.
inline constexpr int max_reads = 64;

/// Reads the newest snapshot by `read(snapshot)`, which loads words by shared_words.hpp and returns
/// whether it found what it looked for. The result is `none` also if there was no tick so far.
template <class Read>
[[nodiscard]] ReadResult read_newest(const spm_shared_state& state, const Read& read) noexcept {
  for (int attempt = 0; attempt < max_reads; ++attempt) {
    const std::uint64_t published = load_acquire(state.published);
    if (published == 0) return ReadResult::none;
    const spm_shared_snapshot& snapshot = state.snapshots[(published - 1) & 1];
    bool found = false;
    if (read_sequenced(snapshot.sequence, [&] { found = read(snapshot); })) {
      return found ? ReadResult::fine : ReadResult::none;
    }
  }
  return ReadResult::busy;
}

/// The number of devices and objects in a snapshot, never more than there is room for.
[[nodiscard]] inline std::uint32_t device_count(const spm_shared_snapshot& snapshot) noexcept {
  return std::min<std::uint32_t>(load_relaxed(snapshot.device_count), SPM_MAX_DEVICES);
}
[[nodiscard]] inline std::uint32_t object_count(const spm_shared_snapshot& snapshot) noexcept {
  return std::min<std::uint32_t>(load_relaxed(snapshot.object_count), SPM_MAX_OBJECTS);
}

/// Reads a record that has a sequence lock of its own, by `read`. False if it kept changing.
template <class Read>
[[nodiscard]] bool read_behind(const std::uint64_t& sequence, const Read& read) noexcept {
  for (int attempt = 0; attempt < max_reads; ++attempt) {
    if (read_sequenced(sequence, read)) return true;
  }
  return false;
}

/// Reads part of what seldom changes, by `read(info)`. False if it kept changing.
template <class Read>
[[nodiscard]] bool read_info(const spm_shared_state& state, const Read& read) noexcept {
  return read_behind(state.info_sequence, [&] { read(state.info); });
}

}  // namespace spm::servo
