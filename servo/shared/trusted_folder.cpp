// SPDX-License-Identifier: Apache-2.0
#include "servo/shared/trusted_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

namespace spm::servo {

namespace {

namespace fs = std::filesystem;

constexpr const char* cure = ": name a folder of your own that is closed to others (mode 700)";

bool is_trusted(uid_t owner, uid_t other) noexcept {
  return owner == 0 || owner == geteuid() || owner == other;
}

/// What is wrong with one folder or link. `last`: it is the folder itself, no parent.
std::string fault_of(const fs::path& path, bool last, uid_t other) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0) return "";
  const std::string name = path.string();
  if (!is_trusted(status.st_uid, other)) {
    return name + " belongs to another user (" + std::to_string(status.st_uid) + ")" + cure;
  }
  if (S_ISLNK(status.st_mode)) return last ? name + " is a link" + cure : "";
  if (!S_ISDIR(status.st_mode)) return name + " is no folder" + cure;
  const bool shared = (status.st_mode & (S_IWGRP | S_IWOTH)) != 0;
  // In a parent with the sticky bit, such as /tmp, nobody can replace what is not his.
  const bool sticky = (status.st_mode & S_ISVTX) != 0;
  if (!shared || (sticky && !last)) return "";
  return name + " is open to writing by others" + cure;
}

/// The first fault on the way from the root to a folder.
std::string fault_on_the_way(const fs::path& folder, uid_t other) {
  fs::path so_far;
  std::string fault;
  for (auto part = folder.begin(); part != folder.end() && fault.empty(); ++part) {
    so_far /= *part;
    fault = fault_of(so_far, std::next(part) == folder.end(), other);
  }
  return fault;
}

}  // namespace

std::string distrust_of(const std::string& folder, uid_t other) {
  std::error_code problem;
  const fs::path given = fs::absolute(folder, problem);
  if (problem) return folder + " cannot be looked at (" + problem.message() + ")" + cure;
  // A last part that is empty is a slash at the end.
  const fs::path path = given.has_filename() ? given : given.parent_path();
  std::string fault = fault_on_the_way(path, other);
  if (!fault.empty()) return fault;
  // Where links of root's or our own lead.
  const fs::path real = fs::canonical(path, problem);
  return problem || real == path ? "" : fault_on_the_way(real, other);
}

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace spm::servo
