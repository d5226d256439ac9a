// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "servo/shared/shared_layout.h"
#include "servo/shared/shared_words.hpp"

namespace spm::servo {

/// A client's region of memory, as the server passes it to the loop.
struct AttachedRing {
  spm_shared_ring* ring = nullptr;
  std::uint32_t connection = 0;  ///< from 1, never used again
  bool supervisor = false;       ///< may change what is another application's
  bool observer = false;         ///< changes nothing
};

/// What the loop found at the next place of a ring.
enum class RingEntry : std::uint8_t { command, empty, garbage };

/// A place for one client's ring. The server attaches and detaches rings without a lock; the loop
/// takes commands. The loop announces what it uses (a hazard pointer), so that the server knows
/// when a ring's memory may be unmapped. A value that is read from the ring is never used as an
/// index or a count before it was bounded, and nothing is read twice.
class ClientRing {
 public:
  /// Server: offers a ring, or none (null). It may offer a new one only when the old one is
  /// `released`.
  void offer(const AttachedRing* attached) noexcept { offered_.store(attached); }

  /// Server: true if the loop neither uses the ring nor can come back to it. The ring must have
  /// been replaced by another `offer`.
  [[nodiscard]] bool released(const AttachedRing* attached) const noexcept {
    return in_use_.load() != attached;
  }

  /// Loop: begins to use the ring that is offered. Returns its connection, or 0 if there is none.
  /// Each `begin` is followed by an `end`.
  [[nodiscard]] std::uint32_t begin() noexcept {
    const AttachedRing* const attached = offered_.load(std::memory_order_relaxed);
    if (attached == nullptr) return 0;
    in_use_.store(attached);
    // A ring that is no longer offered may already be unmapped.
    if (offered_.load() != attached) return 0;
    current_ = attached;
    return attached->connection;
  }
  void end() noexcept {
    current_ = nullptr;
    in_use_.store(nullptr, std::memory_order_release);
  }

  /// Loop: the connection whose commands are taken; 0 before the first `adopt`.
  [[nodiscard]] std::uint32_t adopted() const noexcept { return connection_; }
  /// Loop: whether that connection is a supervisor's.
  [[nodiscard]] bool supervisor() const noexcept { return supervisor_; }
  /// Loop: whether it is an observer's, whose commands are all refused.
  [[nodiscard]] bool observer() const noexcept { return observer_; }
  /// Loop, between `begin` and `end`: from now on takes the commands of the ring that is there now,
  /// from its first one on.
  void adopt() noexcept {
    connection_ = current_ != nullptr ? current_->connection : 0;
    supervisor_ = current_ != nullptr && current_->supervisor;
    observer_ = current_ != nullptr && current_->observer;
    tail_ = refused_ = garbage_ = 0;
  }

  /// Loop, between `begin` and `end`, if a ring is there: a number that changes with every call of
  /// the application's library.
  [[nodiscard]] std::uint64_t sign_of_life() const noexcept {
    return load_relaxed(current_->ring->calls) + load_relaxed(current_->ring->head);
  }

  /// Loop, between `begin` and `end`, if a ring is there: the next command. Garbage costs no more
  /// time than a command.
  [[nodiscard]] RingEntry next(spm_shared_command& command) noexcept {
    spm_shared_ring& ring = *current_->ring;
    const std::uint64_t head = load_acquire(ring.head);
    if (head == tail_) return RingEntry::empty;
    if (head - tail_ > SPM_RING_SLOTS) {
      // More than the ring holds: nothing up to there can be trusted.
      tail_ = head;
      return count_garbage(ring);
    }
    command = load_record(ring.slots[tail_ % SPM_RING_SLOTS]);
    ++tail_;
    if (command.sequence != tail_) return count_garbage(ring);
    store_release(ring.tail, tail_);
    return RingEntry::command;
  }

  /// Loop, between `begin` and `end`, if a ring is there: tells the client why a command was not
  /// followed.
  void refuse(std::uint64_t sequence, std::uint32_t refusal) noexcept {
    spm_shared_ring& ring = *current_->ring;
    store_relaxed(ring.last_refused, sequence);
    store_relaxed(ring.last_refusal, refusal);
    store_release(ring.refused, ++refused_);
  }

 private:
  RingEntry count_garbage(spm_shared_ring& ring) noexcept {
    store_relaxed(ring.garbage, ++garbage_);
    store_release(ring.tail, tail_);
    return RingEntry::garbage;
  }

  std::atomic<const AttachedRing*> offered_{nullptr};
  std::atomic<const AttachedRing*> in_use_{nullptr};
  // Used by the loop alone:
  const AttachedRing* current_ = nullptr;
  std::uint32_t connection_ = 0;  ///< the one that the following members belong to
  bool supervisor_ = false, observer_ = false;
  std::uint64_t tail_ = 0, refused_ = 0, garbage_ = 0;
};

}  // namespace spm::servo
