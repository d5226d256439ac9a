// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/objects/asset_cache.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "baker/base/bake_error.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/files/sha256.hpp"
#include "tests/bench/base/unwrap.hpp"

namespace spm::stability {
namespace {

namespace fs = std::filesystem;

/// A hash of a text, short enough for a file's name.
std::string short_hash(const std::string& text) { return sha256_bytes(text).substr(0, 20); }

/// Keeps other processes that ask for the same file's lock waiting while it lives.
class FileLock {
 public:
  explicit FileLock(const fs::path& path)
      : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (file_ < 0 || ::flock(file_, LOCK_EX) != 0) {
      const std::error_code why(errno, std::generic_category());
      if (file_ >= 0) ::close(file_);
      throw fs::filesystem_error("cannot be locked", path, why);
    }
  }
  ~FileLock() { ::close(file_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int file_;
};

/// The folder of the running program: one folder per program, and in it one per build.
fs::path build_folder() {
  fs::create_directories(cache_folder());
  // So that no process clears away what another has just made.
  const FileLock lock(fs::path(cache_folder()) / "lock");
  const fs::path program = fs::read_symlink("/proc/self/exe");
  const auto written = fs::last_write_time(program).time_since_epoch().count();
  const fs::path all = fs::path(cache_folder()) / short_hash(program.string());
  fs::path own = all / fmt::format("{}-{}", written, fs::file_size(program));
  if (!fs::is_directory(own)) {
    std::error_code ignored;
    fs::remove_all(all, ignored);
  }
  fs::create_directories(own);
  return own;
}

}  // namespace

std::string cache_folder() {
  const auto named = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value != nullptr ? value : "");
  };
  if (const fs::path own = named("SPM_STABILITY_CACHE"); !own.empty()) return own.string();
  fs::path user = named("XDG_CACHE_HOME");
  if (user.empty() && !named("HOME").empty()) user = named("HOME") / ".cache";
  if (user.empty()) user = fs::temp_directory_path();
  return (user / "spm-stability").string();
}

std::unique_ptr<MappedAsset> cached_asset(const baker::Mesh& mesh, const std::string& content,
                                          const baker::BakeOptions& options) try {
  const std::string asked =
      fmt::format("{} {:.17g} {:.17g} {:.17g}", content, options.tolerance.value_or(-1),
                  options.max_depth, options.probe_radius);
  const std::string path = (build_folder() / (short_hash(asked) + ".spm.exr")).string();
  // One process bakes, the others wait for it.
  const FileLock lock(path + ".lock");
  if (!fs::exists(path)) {
    const baker::BakeResult baked = baker::bake(mesh, options);
    static_cast<void>(bench::unwrap(write_asset(baked.asset, path)));
  }
  return bench::unwrap(MappedAsset::open(path));
} catch (const fs::filesystem_error& error) {
  throw baker::BakeError(
      ExitCode::file_or_device,
      std::string(error.what()) + "; name a folder that can be written to by SPM_STABILITY_CACHE");
}

}  // namespace spm::stability
