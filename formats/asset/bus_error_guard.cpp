// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/bus_error_guard.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <mutex>

namespace spm {
namespace {

/// A guarded mapping. `begin` is written last and cleared first: the handler reads it first.
struct Slot {
  std::atomic<bool> taken{false};
  std::atomic<bool> lost{false};
  std::atomic<std::uintptr_t> begin{0};
  std::atomic<std::uintptr_t> end{0};
};
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free);

constinit std::array<Slot, 1024> slots;
constinit std::atomic<std::uintptr_t> page_size{4096};
struct sigaction previous_action;

/// Replaces the slot's pages by zeros, from the one that contains `address` on.
bool replace_lost_pages(std::uintptr_t address) noexcept {
  for (Slot& slot : slots) {
    const std::uintptr_t begin = slot.begin.load(std::memory_order_acquire);
    const std::uintptr_t end = slot.end.load(std::memory_order_relaxed);
    if (begin == 0 || address < begin || address >= end) continue;
    const std::uintptr_t page = address & ~(page_size.load(std::memory_order_relaxed) - 1);
    slot.lost.store(true, std::memory_order_release);
    return ::mmap(reinterpret_cast<void*>(page), end - page, PROT_READ,
                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
  }
  return false;
}

// Uses async-signal-safe calls only: atomics, mmap, sigaction, raise.
void handle_bus_error(int signal, siginfo_t* info, void*) noexcept {
  const int kept_errno = errno;
  const bool fault = info->si_code > 0;  // not sent by kill()
  if (!fault || !replace_lost_pages(reinterpret_cast<std::uintptr_t>(info->si_addr))) {
    // Not our fault: the instruction faults again and reaches the handler that was there before.
    ::sigaction(signal, &previous_action, nullptr);
    if (!fault) ::raise(signal);
  }
  errno = kept_errno;
}

bool install_handler() noexcept {
  static std::once_flag once;
  static bool installed = false;
  std::call_once(once, [] {
    page_size.store(static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE)));
    struct sigaction action {};
    action.sa_sigaction = handle_bus_error;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigemptyset(&action.sa_mask);
    installed = ::sigaction(SIGBUS, &action, &previous_action) == 0;
  });
  return installed;
}

}  // namespace

bool BusErrorGuard::watch(const void* begin, std::size_t size) noexcept {
  if (!install_handler()) return false;
  for (std::size_t index = 0; index < slots.size(); ++index) {
    Slot& slot = slots[index];
    if (slot.taken.exchange(true, std::memory_order_acquire)) continue;
    slot.lost.store(false, std::memory_order_relaxed);
    slot.end.store(reinterpret_cast<std::uintptr_t>(begin) + size, std::memory_order_relaxed);
    slot.begin.store(reinterpret_cast<std::uintptr_t>(begin), std::memory_order_release);
    slot_ = static_cast<std::ptrdiff_t>(index);
    return true;
  }
  return false;
}

bool BusErrorGuard::lost() const noexcept {
  return slot_ >= 0 && slots[static_cast<std::size_t>(slot_)].lost.load(std::memory_order_acquire);
}

BusErrorGuard::~BusErrorGuard() {
  if (slot_ < 0) return;
  Slot& slot = slots[static_cast<std::size_t>(slot_)];
  slot.begin.store(0, std::memory_order_release);
  slot.taken.store(false, std::memory_order_release);
}

}  // namespace spm
