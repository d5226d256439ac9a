// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/file_mapping.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>

#include "formats/files/checksum.hpp"

namespace spm {
namespace {

constexpr std::int64_t clock_step_ns = 50'000'000;  // coarser than any kernel's time stamps

std::int64_t nanoseconds(const timespec& time) noexcept {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

bool same_time(const timespec& a, const timespec& b) noexcept {
  return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

bool recently(const timespec& time) noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return nanoseconds(now) - nanoseconds(time) < clock_step_ns;
}

tl::unexpected<Error> cannot(const std::string& path, const char* what, int cause,
                             const char* cure) {
  return fail(ExitCode::file_or_device,
              path + ": cannot be " + what + ": " + std::strerror(cause) + "; " + cure);
}

/// Copies a file into memory that nobody can change any more. Returns the descriptor, or -1 and
/// errno.
int sealed_copy(int source, std::uint64_t size) {
  const int copy = ::memfd_create("spm-asset", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (copy < 0) return -1;
  off_t offset = 0;
  while (static_cast<std::uint64_t>(offset) < size) {
    const ssize_t count =
        ::sendfile(copy, source, &offset, size - static_cast<std::uint64_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int cause = count < 0 ? errno : EIO;
      ::close(copy);
      errno = cause;
      return -1;
    }
  }
  if (::fcntl(copy, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL) != 0) {
    const int cause = errno;
    ::close(copy);
    errno = cause;
    return -1;
  }
  return copy;
}

}  // namespace

FileMapping::~FileMapping() {
  guard_.reset();
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> FileMapping::map(int descriptor, const MapOptions& options) {
  const auto size = static_cast<std::size_t>(opened_.st_size);
  const int populate = options.prefault ? MAP_POPULATE : 0;
  void* start = ::mmap(nullptr, size, PROT_READ, MAP_SHARED | populate, descriptor, 0);
  if (start == MAP_FAILED) {
    return cannot(path_, "mapped", errno, "put it on a file system that can be mapped");
  }
  bytes_ = {static_cast<const std::byte*>(start), size};
  if (!guard_->watch(start, size)) {
    return fail(ExitCode::file_or_device,
                path_ + ": too many assets are mapped at once; close some first");
  }
  locked_ = options.lock && ::mlock(start, size) == 0;
  return {};
}

Result<std::unique_ptr<FileMapping>> FileMapping::open(const std::string& path,
                                                       const MapOptions& options) {
  std::unique_ptr<FileMapping> file(new FileMapping);
  file->path_ = path;
  // O_NONBLOCK: a named pipe must not block the program.
  file->descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file->descriptor_ < 0) {
    return cannot(path, "opened", errno, "check the path and its permissions");
  }
  if (::fstat(file->descriptor_, &file->opened_) != 0) {
    return cannot(path, "examined", errno, "check the disk");
  }
  if (!S_ISREG(file->opened_.st_mode)) {
    return fail(ExitCode::file_or_device,
                path + ": is " +
                    (S_ISDIR(file->opened_.st_mode) ? "a folder" : "not a regular file") +
                    "; give an asset that spm-bake build wrote");
  }
  if (file->opened_.st_size == 0) {
    return fail(ExitCode::invalid_input, path + ": is empty; bake one with spm-bake build");
  }
  file->young_ = recently(file->opened_.st_mtim);
  int descriptor = file->descriptor_;
  if (options.mode == MapMode::sealed) {
    descriptor = sealed_copy(file->descriptor_, static_cast<std::uint64_t>(file->opened_.st_size));
    if (descriptor < 0) {
      return cannot(path, "copied into sealed memory", errno,
                    "free some memory, or use --map file");
    }
  }
  Result<void> mapped = file->map(descriptor, options);
  if (options.mode == MapMode::sealed) ::close(descriptor);
  if (!mapped) return tl::make_unexpected(std::move(mapped.error()));
  return file;
}

void FileMapping::touch() const noexcept {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const volatile std::byte* start = bytes_.data();
  for (std::size_t at = 0; at < bytes_.size(); at += page) static_cast<void>(start[at]);
}

void FileMapping::set_checksum(std::uint64_t digits_at, std::uint64_t checksum) noexcept {
  digits_at_ = digits_at;
  checksum_ = checksum;
}

bool FileMapping::content_changed(const struct stat& now) noexcept {
  const auto checksum =
      file_checksum(descriptor_, static_cast<std::uint64_t>(now.st_size), digits_at_);
  if (checksum != checksum_) return true;
  opened_.st_ctim = now.st_ctim;
  young_ = young_ && recently(now.st_mtim);
  return false;
}

AssetState FileMapping::state() noexcept {
  struct stat now {};
  if (::fstat(descriptor_, &now) != 0 || now.st_size < opened_.st_size || lost()) {
    return AssetState::truncated;
  }
  if (now.st_size != opened_.st_size || !same_time(now.st_mtim, opened_.st_mtim)) {
    return AssetState::edited;
  }
  if ((young_ || !same_time(now.st_ctim, opened_.st_ctim)) && content_changed(now)) {
    return AssetState::edited;
  }
  struct stat named {};
  if (::stat(path_.c_str(), &named) != 0) return AssetState::deleted;
  if (named.st_dev != now.st_dev || named.st_ino != now.st_ino) return AssetState::replaced;
  return AssetState::intact;
}

}  // namespace spm
