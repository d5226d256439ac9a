// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/fuzz_target.hpp"

namespace spm::fuzz {

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

ScratchFile::ScratchFile()
    : path_((std::filesystem::temp_directory_path() / "spm-fuzz-XXXXXX").string()) {
  handle_ = ::mkstemp(path_.data());
  require(handle_ >= 0, "a scratch file can be made");
}

ScratchFile::~ScratchFile() {
  ::close(handle_);
  ::unlink(path_.c_str());
}

void ScratchFile::write(std::string_view bytes) {
  require(::ftruncate(handle_, 0) == 0, "a scratch file can be emptied");
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t written =
        ::pwrite(handle_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
    require(written > 0, "a scratch file can be written");
    at += static_cast<std::size_t>(written);
  }
}

}  // namespace spm::fuzz
