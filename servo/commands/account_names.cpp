// SPDX-License-Identifier: Apache-2.0
#include "servo/commands/account_names.hpp"

#include <grp.h>
#include <pwd.h>

#include <charconv>
#include <optional>

namespace spm::servo {

namespace {

std::optional<std::uint32_t> number_of(const std::string& text) noexcept {
  std::uint32_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, number);
  const bool is_id = problem == std::errc() && stop == end && number < UINT32_MAX;
  return is_id ? std::optional(number) : std::nullopt;
}

}  // namespace

// A single thread reads the command line, so that the functions that are not for several will do.

Result<std::uint32_t> user_id(const std::string& text) {
  if (const passwd* const known = getpwnam(text.c_str())) return known->pw_uid;
  if (const auto number = number_of(text)) return *number;
  return fail(ExitCode::usage,
              "there is no user '" + text + "': give a name that 'getent passwd' knows, or an id");
}

Result<std::uint32_t> group_id(const std::string& text) {
  if (const group* const known = getgrnam(text.c_str())) return known->gr_gid;
  if (const auto number = number_of(text)) return *number;
  return fail(ExitCode::usage, "there is no group '" + text +
                                   "': make it with 'sudo groupadd --system " + text +
                                   "', or give a name that 'getent group' knows, or an id");
}

}  // namespace spm::servo
