// SPDX-License-Identifier: Apache-2.0
#include "servo/app/shared_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

namespace spm::servo {

namespace {

std::size_t page_bytes() noexcept { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }

tl::unexpected<Error> cannot(const std::string& name, const std::string& what, int code) {
  return fail(ExitCode::file_or_device,
              "shared memory '" + name + "' could not be " + what + " (" + std::strerror(code) +
                  "): free some memory, or raise the limits of open files and of locked memory");
}

}  // namespace

Result<SharedMemory> SharedMemory::create(const std::string& name, std::size_t bytes) {
  const std::size_t whole = (bytes + page_bytes() - 1) / page_bytes() * page_bytes();
  const int descriptor = memfd_create(name.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (descriptor < 0) return cannot(name, "made", errno);
  SharedMemory memory(descriptor, nullptr, whole);
  if (ftruncate(descriptor, static_cast<off_t>(whole)) != 0) return cannot(name, "sized", errno);
  // A client that could shrink the file could end the daemon by a bus error.
  if (fcntl(descriptor, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0) {
    return cannot(name, "sealed", errno);
  }
  void* const data =
      mmap(nullptr, whole, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, descriptor, 0);
  if (data == MAP_FAILED) return cannot(name, "mapped", errno);
  memory.data_ = data;
  // If a limit refuses this, it is not reported here: the loop's start warns of it.
  static_cast<void>(mlock(data, whole));
  memory.touch();
  return memory;
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      data_(std::exchange(other.data_, nullptr)),
      bytes_(other.bytes_) {}

SharedMemory& SharedMemory::operator=(SharedMemory&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

SharedMemory::~SharedMemory() {
  if (data_ != nullptr) munmap(data_, bytes_);
  if (descriptor_ >= 0) close(descriptor_);
}

Result<int> SharedMemory::read_only_descriptor() const {
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor_);
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return cannot(path, "opened for reading", errno);
  return descriptor;
}

bool SharedMemory::close_to_others() noexcept {
  if (fcntl(descriptor_, F_ADD_SEALS, F_SEAL_FUTURE_WRITE | F_SEAL_SEAL) != 0 && errno != EINVAL) {
    return false;
  }
  touch();
  return true;
}

/// Brings every page into memory, without a change.
void SharedMemory::touch() const noexcept {
  auto* const words = static_cast<std::uint64_t*>(data_);
  for (std::size_t offset = 0; offset < bytes_; offset += page_bytes()) {
    __atomic_fetch_or(words + offset / sizeof(std::uint64_t), 0, __ATOMIC_RELAXED);
  }
}

}  // namespace spm::servo
