// SPDX-License-Identifier: Apache-2.0
#include "servo/record/black_box_memory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>

#include "formats/motion/recording.hpp"

namespace spm::servo {

namespace {

constexpr std::size_t start_room = std::size_t{1} << 20U;
constexpr std::size_t changes_room = std::size_t{1} << 22U;
constexpr std::size_t part_head = 8;

tl::unexpected<Error> no_memory(int error_number) {
  return fail(ExitCode::file_or_device, std::string("no memory for the black box (") +
                                            std::strerror(error_number) +
                                            "): free some, or run with --black-box off");
}

}  // namespace

/// At the beginning of the memory; the halves follow it.
struct BlackBoxMemory::Head {
  struct Half {
    std::atomic<std::uint64_t> start{0};  ///< bytes of the start; 0: nothing is there
    std::atomic<std::uint64_t> used{0};   ///< bytes, with the start
  };
  std::atomic<std::uint32_t> current{0};
  std::array<Half, 2> halves;
};

std::size_t BlackBoxMemory::bytes_for(std::size_t devices, double rate_hz, double seconds) {
  const auto rows = devices * static_cast<std::size_t>(std::ceil(seconds * rate_hz));
  const std::size_t bytes = start_room + changes_room + rows * (part_head + sizeof(RecordingRow));
  return bytes - bytes % 4096;
}

Result<std::unique_ptr<BlackBoxMemory>> BlackBoxMemory::make(std::size_t half_bytes) {
  const int descriptor = memfd_create("spm-black-box", MFD_CLOEXEC);
  const auto bytes = static_cast<off_t>(sizeof(Head) + 2 * half_bytes);
  if (descriptor < 0 || ftruncate(descriptor, bytes) != 0) {
    auto refused = no_memory(errno);
    if (descriptor >= 0) close(descriptor);
    return refused;
  }
  auto made = attach(descriptor, half_bytes);
  if (made) {
    new ((*made)->head_) Head;
  } else {
    close(descriptor);
  }
  return made;
}

Result<std::unique_ptr<BlackBoxMemory>> BlackBoxMemory::attach(int descriptor,
                                                               std::size_t half_bytes) {
  void* memory = mmap(nullptr, sizeof(Head) + 2 * half_bytes, PROT_READ | PROT_WRITE, MAP_SHARED,
                      descriptor, 0);
  if (memory == MAP_FAILED) return no_memory(errno);
  return std::unique_ptr<BlackBoxMemory>(
      new BlackBoxMemory(static_cast<Head*>(memory), half_bytes, descriptor));
}

BlackBoxMemory::~BlackBoxMemory() {
  munmap(head_, sizeof(Head) + 2 * half_bytes_);
  close(descriptor_);
}

char* BlackBoxMemory::half(std::size_t which) const noexcept {
  return reinterpret_cast<char*>(head_ + 1) + which * half_bytes_;
}

bool BlackBoxMemory::begin(std::string_view start) noexcept {
  if (start.empty() || start.size() > half_bytes_) return false;
  const std::uint32_t next = 1 - head_->current.load(std::memory_order_relaxed) % 2;
  Head::Half& there = head_->halves[next];
  there.start.store(0, std::memory_order_release);
  std::memcpy(half(next), start.data(), start.size());
  there.used.store(start.size(), std::memory_order_relaxed);
  there.start.store(start.size(), std::memory_order_release);
  head_->current.store(next, std::memory_order_release);
  return true;
}

bool BlackBoxMemory::append(std::string_view part) noexcept {
  const std::uint32_t now = head_->current.load(std::memory_order_relaxed) % 2;
  Head::Half& there = head_->halves[now];
  const std::uint64_t used = there.used.load(std::memory_order_relaxed);
  if (there.start.load(std::memory_order_relaxed) == 0 || part.size() > half_bytes_ - used) {
    return false;
  }
  std::memcpy(half(now) + used, part.data(), part.size());
  there.used.store(used + part.size(), std::memory_order_release);
  return true;
}

bool BlackBoxMemory::empty() const noexcept {
  return std::all_of(head_->halves.begin(), head_->halves.end(),
                     [](const Head::Half& one) { return one.start.load() == 0; });
}

// What a process that went astray left in the head is held to the memory's bounds.

std::string_view BlackBoxMemory::start_of(std::size_t which) const noexcept {
  const std::uint64_t size = head_->halves[which].start.load(std::memory_order_acquire);
  return {half(which), std::min<std::uint64_t>(size, half_bytes_)};
}

std::string_view BlackBoxMemory::parts_of(std::size_t which) const noexcept {
  const std::size_t start = start_of(which).size();
  if (start == 0) return {};
  const std::uint64_t used = head_->halves[which].used.load(std::memory_order_acquire);
  return {half(which) + start, std::clamp<std::uint64_t>(used, start, half_bytes_) - start};
}

Result<void> BlackBoxMemory::write(const std::string& path) const {
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
  const std::size_t now = head_->current.load(std::memory_order_acquire) % 2;
  const std::size_t before = 1 - now;
  const std::string_view start = start_of(before).empty() ? start_of(now) : start_of(before);
  const std::array parts{parts_of(before), parts_of(now)};
  return write_recording(path, start, parts);
}

}  // namespace spm::servo
