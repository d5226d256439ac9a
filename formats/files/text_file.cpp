// SPDX-License-Identifier: Apache-2.0
#include "formats/files/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace spm {

Result<std::string> read_text_file(const std::string& path, const std::string& wanted) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return fail(ExitCode::file_or_device, path + ": is a folder; give " + wanted);
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return fail(ExitCode::file_or_device, path + ": cannot be opened: " + std::strerror(errno) +
                                              "; check the name and its permissions");
  }
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) return fail(ExitCode::file_or_device, path + ": cannot be read; check the disk");
  return text;
}

bool is_special_file(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

Result<std::string> read_regular_file(const std::string& path, const std::string& wanted) {
  if (is_special_file(path)) {
    return fail(ExitCode::file_or_device, path + ": is a device or a pipe; give " + wanted);
  }
  return read_text_file(path, wanted);
}

}  // namespace spm
