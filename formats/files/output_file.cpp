// SPDX-License-Identifier: Apache-2.0
#include "formats/files/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

namespace spm {
namespace {

tl::unexpected<Error> write_error(const std::string& path, int cause) {
  const bool full = cause == ENOSPC || cause == EDQUOT || cause == EFBIG;
  return fail(ExitCode::file_or_device,
              path + ": cannot be written: " + std::strerror(cause) +
                  (full ? "; free some space or write elsewhere"
                        : "; give a path in a folder that can be written"));
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

std::string temporary_name(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return path + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
}

}  // namespace

OutputFile::OutputFile(std::string path, std::string temporary, int descriptor) noexcept
    : path_(std::move(path)), temporary_(std::move(temporary)), descriptor_(descriptor) {}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, std::string())),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  if (this != &other) {
    discard();
    path_ = std::move(other.path_);
    temporary_ = std::exchange(other.temporary_, std::string());
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() noexcept {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (!temporary_.empty()) ::unlink(std::exchange(temporary_, std::string()).c_str());
}

Result<OutputFile> OutputFile::create(const std::string& path, WhileOpen while_open) {
  if (path.empty() || path.back() == '/') {
    return fail(ExitCode::file_or_device,
                "\"" + path + "\": is not the name of a file; give a file name to write to");
  }
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    return fail(ExitCode::file_or_device,
                path + ": is " + (S_ISDIR(status.st_mode) ? "a folder" : "not a regular file") +
                    " and cannot be written; give the name of a file");
  }
  const std::string folder = folder_of(path);
  if (::stat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) {
    return fail(ExitCode::file_or_device,
                path + ": cannot be written: there is no folder " + folder + "; create it first");
  }
  // A file without a name vanishes with the process, however that ends. It gets a name by way of
  // /proc. Not every file system has such files.
  if (while_open == WhileOpen::nameless && ::access("/proc/self/fd", X_OK) == 0) {
    const int nameless = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (nameless >= 0) {
      // The name may be too long; that must show before an hour of work.
      if (::stat(temporary_name(path).c_str(), &status) == 0 || errno == ENOENT) {
        return OutputFile(path, std::string(), nameless);
      }
      const int cause = errno;
      ::close(nameless);
      return write_error(path, cause);
    }
  }
  for (;;) {
    std::string temporary = temporary_name(path);
    const int descriptor = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return OutputFile(path, std::move(temporary), descriptor);
    // The name is taken where a process of the same number was killed, or runs on another machine.
    if (errno != EEXIST) return write_error(path, errno);
  }
}

bool OutputFile::give_name() {
  const std::string open_file = "/proc/self/fd/" + std::to_string(descriptor_);
  for (;;) {
    std::string temporary = temporary_name(path_);
    if (::linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, temporary.c_str(), AT_SYMLINK_FOLLOW) ==
        0) {
      temporary_ = std::move(temporary);
      return true;
    }
    if (errno != EEXIST) return false;
  }
}

Result<void> OutputFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return write_error(path_, errno);
    offset += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

Result<void> OutputFile::commit() {
  if (::fsync(descriptor_) != 0) return write_error(path_, errno);
  if (temporary_.empty() && !give_name()) return write_error(path_, errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) return write_error(path_, errno);
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return write_error(path_, errno);
  temporary_.clear();
  // The rename itself must survive a power cut. Some file systems cannot sync a folder; that is no
  // reason to report a complete file as failed.
  const int folder = ::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return {};
}

Result<void> write_file(const std::string& path, std::string_view content) {
  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  if (auto written = file->write_at(0, std::as_bytes(std::span(content))); !written) return written;
  return file->commit();
}

}  // namespace spm
