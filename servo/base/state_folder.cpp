// SPDX-License-Identifier: Apache-2.0
#include "servo/base/state_folder.hpp"

#include <cstdlib>
#include <filesystem>

namespace spm::servo {

std::string state_folder() {
  const auto from = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
  };
  std::filesystem::path folder = from("XDG_STATE_HOME");
  if (folder.empty() && !from("HOME").empty()) folder = from("HOME") / ".local" / "state";
  if (!folder.is_absolute()) return {};
  return folder / "spm-servo";
}

}  // namespace spm::servo
