// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace spm::servo {

static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "words are shared by processes");

/// A record of shared_layout.h consists of whole words and has no members but data.
template <class Record>
concept WordRecord = std::is_trivially_copyable_v<Record> && sizeof(Record) % 8 == 0 &&
                     alignof(Record) == 8;

// The compiler's atomics are used, not std::atomic_ref, because that one cannot read memory that is
// mapped read-only.

/// Reads a word or half word that another process may write at the same time.
template <class Word>
[[nodiscard]] Word load_relaxed(const Word& shared) noexcept {
  Word value;
  __atomic_load(&shared, &value, __ATOMIC_RELAXED);
  return value;
}
template <class Word>
[[nodiscard]] Word load_acquire(const Word& shared) noexcept {
  Word value;
  __atomic_load(&shared, &value, __ATOMIC_ACQUIRE);
  return value;
}

/// Writes a word or half word that another process may read at the same time.
template <class Word>
void store_relaxed(Word& shared, std::type_identity_t<Word> value) noexcept {
  __atomic_store(&shared, &value, __ATOMIC_RELAXED);
}
template <class Word>
void store_release(Word& shared, std::type_identity_t<Word> value) noexcept {
  __atomic_store(&shared, &value, __ATOMIC_RELEASE);
}

/// Copies `bytes` (whole words) out of shared memory, a word at a time.
inline void load_words(void* to, const void* shared, std::size_t bytes) noexcept {
  const auto* const from = static_cast<const std::uint64_t*>(shared);
  auto* const out = static_cast<unsigned char*>(to);
  for (std::size_t word = 0; word < bytes / 8; ++word) {
    const std::uint64_t value = __atomic_load_n(from + word, __ATOMIC_RELAXED);
    std::memcpy(out + 8 * word, &value, 8);
  }
}

/// Copies `bytes` (whole words) into shared memory, a word at a time.
inline void store_words(void* shared, const void* from, std::size_t bytes) noexcept {
  auto* const to = static_cast<std::uint64_t*>(shared);
  const auto* const in = static_cast<const unsigned char*>(from);
  for (std::size_t word = 0; word < bytes / 8; ++word) {
    std::uint64_t value = 0;
    std::memcpy(&value, in + 8 * word, 8);
    __atomic_store_n(to + word, value, __ATOMIC_RELAXED);
  }
}

template <WordRecord Record>
[[nodiscard]] Record load_record(const Record& shared) noexcept {
  Record record;
  load_words(&record, &shared, sizeof record);
  return record;
}
template <WordRecord Record>
void store_record(Record& shared, const Record& record) noexcept {
  store_words(&shared, &record, sizeof record);
}

/// Writes behind a sequence lock. `write` stores words by the functions above. Only one writer is
/// allowed.
template <class Write>
void write_sequenced(std::uint64_t& sequence, const Write& write) noexcept {
  const std::uint64_t before = load_relaxed(sequence);
  store_relaxed(sequence, before + 1);
  std::atomic_thread_fence(std::memory_order_release);
  write();
  store_release(sequence, before + 2);
}

/// Reads behind a sequence lock. `read` loads words by the functions above. True if none of them
/// was written meanwhile; otherwise what was read must be discarded.
template <class Read>
[[nodiscard]] bool read_sequenced(const std::uint64_t& sequence, const Read& read) noexcept {
  const std::uint64_t before = load_acquire(sequence);
  if ((before & 1) != 0) return false;
  read();
  std::atomic_thread_fence(std::memory_order_acquire);
  return load_relaxed(sequence) == before;
}

}  // namespace spm::servo
