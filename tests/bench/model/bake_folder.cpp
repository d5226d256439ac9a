// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/bake_folder.hpp"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "baker/base/bake_error.hpp"

namespace spm::bench {
namespace {

/// File beside a complete asset that holds the seconds of its bake.
std::string seconds_path(const BakedFile& file) { return file.path + ".seconds"; }

void make_folder(const std::string& path) {
  std::error_code failed;
  std::filesystem::create_directories(path, failed);
  if (failed) {
    throw baker::BakeError(
        ExitCode::file_or_device,
        path + ": cannot be made (" + failed.message() + "); name another folder by --bakes");
  }
}

}  // namespace

BakeFolder::BakeFolder(const std::string& kept) : path_(kept) {
  if (kept.empty()) path_ = temporary_.emplace().path();
}

BakedFile BakeFolder::asset(const Model& model, double tolerance) const {
  const std::string folder = (std::filesystem::path(path_) / model.mesh.sha256).string();
  make_folder(folder);
  const SparseOptions options{model.band, tolerance};
  BakedFile there = baked_file(options, folder);
  if (std::ifstream note(seconds_path(there)); note >> there.seconds) {
    there.bytes = std::filesystem::file_size(there.path);
    return there;
  }
  BakedFile baked = bake_sparse(model.mesh, options, folder);
  std::ofstream(seconds_path(baked)) << baked.seconds << '\n';
  return baked;
}

}  // namespace spm::bench
