// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "baker/base/bake_error.hpp"

namespace spm::bench {

/// A new folder under the system's temporary folder. The destructor removes it with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_((std::filesystem::temp_directory_path() / "spm-bench-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) {
      throw baker::BakeError(ExitCode::file_or_device,
                             path_ + ": cannot be made; free the disk or name a folder by TMPDIR");
    }
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
};

}  // namespace spm::bench
