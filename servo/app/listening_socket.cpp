// SPDX-License-Identifier: Apache-2.0
#include "servo/app/listening_socket.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include "servo/shared/descriptor.hpp"
#include "servo/shared/socket_path.hpp"
#include "servo/shared/trusted_folder.hpp"

namespace spm::servo {

namespace {

/// Clients that wait while the server is busy with another one.
constexpr int backlog = 32;
/// Of a socket that does not listen yet. One that a killed daemon left is removed by the next.
constexpr const char* unready_name = ".spm-servo.unready";
/// How long to wait for another daemon that starts at the same moment.
constexpr std::chrono::milliseconds longest_wait{1000}, wait_step{10};

tl::unexpected<Error> failed(const std::string& path, const std::string& why) {
  return fail(ExitCode::file_or_device, path + ": " + why);
}

tl::unexpected<Error> refused(const std::string& path, const std::string& what, int code) {
  return failed(path, what + " (" + std::strerror(code) +
                          "): name another socket with --socket, in a folder that you may write");
}

/// The folder of the sockets must belong to this user, and be closed to others.
Result<void> make_private_folder(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(folder).parent_path(), ignored);
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    return refused(folder, "the folder could not be made", errno);
  }
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0) return refused(folder, "cannot be looked at", errno);
  if (S_ISDIR(status.st_mode) && status.st_uid == geteuid() && (status.st_mode & 077) != 0) {
    return failed(folder, "is open to other users: close it with 'chmod 700 " + folder + "'");
  }
  return {};
}

sockaddr_un address_of(const std::string& path) noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

Result<int> new_socket(const std::string& path) {
  const int descriptor = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return refused(path, "no socket could be made", errno);
  return descriptor;
}

/// Fails if somebody listens at a path already, or something that is no socket lies there.
Result<void> nobody_answers(const std::string& path, const std::string& taken,
                            const std::string& cure) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return {};
    return refused(path, "cannot be looked at", errno);
  }
  if (!S_ISSOCK(status.st_mode)) {
    return failed(path,
                  "is there already and is no socket: remove it, or name another socket with "
                  "--socket");
  }
  auto made = new_socket(path);
  if (!made) return tl::make_unexpected(std::move(made.error()));
  const Descriptor probe(*made);
  const sockaddr_un address = address_of(path);
  const int connected =
      connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  // A daemon whose queue is full is alive too.
  if (connected != 0 && errno == ECONNREFUSED) return {};
  if (connected != 0 && errno != EAGAIN) return refused(path, "cannot be asked", errno);
  ucred peer{};
  socklen_t size = sizeof peer;
  std::string who;
  if (getsockopt(probe.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.pid > 0) {
    who = " (process " + std::to_string(peer.pid) + ")";
  }
  return fail(ExitCode::invalid_input, taken + " belongs to a daemon" + who +
                                           " that runs already: end that one, or " + cure);
}

/// Keeps other daemons out of the folder while this one checks and binds.
Result<int> lock_folder(const std::string& folder) {
  Descriptor locked(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
  if (locked.get() < 0) return refused(folder, "the folder cannot be opened", errno);
  for (auto waited = std::chrono::milliseconds(0); waited < longest_wait; waited += wait_step) {
    if (flock(locked.get(), LOCK_EX | LOCK_NB) == 0) return locked.release();
    if (errno != EWOULDBLOCK && errno != EINTR) break;
    std::this_thread::sleep_for(wait_step);
  }
  return refused(folder, "the folder is locked by another program", errno);
}

/// Lets a group connect too. The folder is closed to writing by others, so that the path still
/// leads to this socket.
bool give_to(const std::string& path, std::optional<gid_t> group) noexcept {
  constexpr auto nobody = static_cast<uid_t>(-1);
  if (!group) return true;
  return lchown(path.c_str(), nobody, *group) == 0 &&
         chmod(path.c_str(), S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP) == 0;
}

/// Makes a socket that listens under a name, in a folder that is open and locked. It is made under
/// another name first: who finds it under its own can connect. False: as errno says.
bool listen_at(int descriptor, int folder, const std::string& name, std::optional<gid_t> group) {
  // Through the descriptor, so that no path is too long for a socket.
  const std::string path = "/proc/self/fd/" + std::to_string(folder) + "/" + unready_name;
  unlink(path.c_str());
  const sockaddr_un address = address_of(path);
  // From the first moment on it is for those alone whom it is meant for.
  static_cast<void>(fchmod(descriptor, S_IRUSR | S_IWUSR));
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return false;
  }
  if (give_to(path, group) && listen(descriptor, backlog) == 0 &&
      renameat(folder, unready_name, folder, name.c_str()) == 0) {
    return true;
  }
  const int code = errno;
  unlink(path.c_str());
  errno = code;
  return false;
}

Result<std::string> chosen_path(const std::string& path, const std::string& name) {
  if (path.empty() && !valid_daemon_name(name)) {
    return fail(ExitCode::usage, "'" + name +
                                     "' is no name for a daemon; take 1 to 32 letters, digits, "
                                     "'-', '_' and '.', the first a letter or digit");
  }
  std::string chosen = path.empty() ? socket_path(name) : path;
  if (chosen.empty()) {
    return fail(ExitCode::file_or_device,
                std::string(no_socket_folder) + ", or name a socket with --socket");
  }
  if (chosen.size() > longest_socket_path || chosen.find('\0') != std::string::npos) {
    return fail(ExitCode::usage, chosen + ": is too long for a socket, which has at most " +
                                     std::to_string(longest_socket_path) +
                                     " bytes; name a shorter one with --socket");
  }
  return chosen;
}

/// The same, for a daemon that was given a path, or else for one of that name.
Result<void> nobody_answers_for(const std::string& chosen, bool is_path, const std::string& name) {
  if (is_path) {
    return nobody_answers(chosen, chosen, "name another socket for this one with --socket");
  }
  return nobody_answers(chosen, "the name '" + name + "' (" + chosen + ")",
                        "give this one a name of its own with --name, by which applications then "
                        "find it");
}

}  // namespace

Result<void> ListeningSocket::check_free(const std::string& path, const std::string& name) {
  const auto chosen = chosen_path(path, name);
  if (!chosen && chosen.error().code == ExitCode::file_or_device) return {};
  if (!chosen) return tl::make_unexpected(chosen.error());
  auto is_free = nobody_answers_for(*chosen, !path.empty(), name);
  if (!is_free && is_free.error().code == ExitCode::file_or_device) return {};
  return is_free;
}

Result<ListeningSocket> ListeningSocket::open(const std::string& path, const std::string& name,
                                              std::optional<gid_t> group) {
  auto chosen = chosen_path(path, name);
  if (!chosen) return tl::make_unexpected(std::move(chosen.error()));
  const std::string folder = folder_of(*chosen);
  if (path.empty() && group) {
    return fail(ExitCode::usage, folder +
                                     ": is closed to --app-group: name a socket with --socket, "
                                     "in a folder of yours that the group may enter (mode 750)");
  }
  if (path.empty()) {
    if (auto made = make_private_folder(folder); !made) {
      return tl::make_unexpected(std::move(made.error()));
    }
  }
  if (const std::string fault = distrust_of(folder); !fault.empty()) {
    return fail(ExitCode::file_or_device,
                "no socket is made where others could replace it: " + fault + ", with --socket");
  }
  auto locked = lock_folder(folder);
  if (!locked) return tl::make_unexpected(std::move(locked.error()));
  const Descriptor lock(*locked);
  if (auto is_free = nobody_answers_for(*chosen, !path.empty(), name); !is_free) {
    return tl::make_unexpected(std::move(is_free.error()));
  }
  auto made = new_socket(*chosen);
  if (!made) return tl::make_unexpected(std::move(made.error()));
  Descriptor descriptor(*made);
  const std::string file = std::filesystem::path(*chosen).filename();
  if (!listen_at(descriptor.get(), lock.get(), file, group)) {
    return refused(*chosen, "no socket can be made there", errno);
  }
  return ListeningSocket(descriptor.release(), std::move(*chosen));
}

ListeningSocket::ListeningSocket(int descriptor, std::string path) noexcept
    : descriptor_(descriptor), path_(std::move(path)) {
  struct stat status {};
  if (lstat(path_.c_str(), &status) != 0) return;
  device_ = status.st_dev;
  file_ = status.st_ino;
}

ListeningSocket::ListeningSocket(ListeningSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      device_(other.device_),
      file_(other.file_) {}

ListeningSocket::~ListeningSocket() {
  if (descriptor_ < 0) return;
  struct stat status {};
  if (lstat(path_.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == file_) {
    unlink(path_.c_str());
  }
  close(descriptor_);
}

}  // namespace spm::servo
