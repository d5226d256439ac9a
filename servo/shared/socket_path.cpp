// SPDX-License-Identifier: Apache-2.0
#include "servo/shared/socket_path.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace spm::servo {

namespace {

constexpr std::size_t longest_name = 32;

/// In any locale.
bool may_be_in_name(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_' || c == '.';
}

bool is_own_folder(const std::string& path) noexcept {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid();
}

}  // namespace

std::string usual_daemon_name() {
  const char* const given = std::getenv(daemon_name_variable);
  return std::string(given != nullptr && *given != '\0' ? given : default_daemon_name.data());
}

std::string socket_folder() {
  // By the XDG base directory specification a relative path must be ignored.
  const char* const given = std::getenv("XDG_RUNTIME_DIR");
  if (given != nullptr && given[0] == '/') return std::string(given) + "/spm-servo";
  const std::string user = std::to_string(geteuid());
  const std::string usual = "/run/user/" + user;
  if (is_own_folder(usual)) return usual + "/spm-servo";
  return "";
}

bool valid_daemon_name(std::string_view name) noexcept {
  return !name.empty() && name.size() <= longest_name && name.front() != '-' &&
         name.front() != '.' && std::all_of(name.begin(), name.end(), may_be_in_name);
}

std::string socket_path(std::string_view name) {
  const std::string folder = socket_folder();
  return folder.empty() ? "" : folder + "/" + std::string(name) + ".sock";
}

}  // namespace spm::servo
