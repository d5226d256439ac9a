// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/model/known_meshes.hpp"

#include <cstdlib>
#include <filesystem>

#include "baker/base/bake_error.hpp"

namespace spm::bench {

const std::vector<KnownMesh>& known_meshes() {
  static const std::vector<KnownMesh> meshes{
      {"duck", 100e-6},    {"spot", 100e-6},   {"rocker-arm", 100e-6}, {"stanford-bunny", 100e-6},
      {"galleon", 100e-6}, {"fandisk", 20e-6}, {"teeth", 50e-6}};
  return meshes;
}

std::string shared_folder() {
  const char* named = std::getenv("SPM_SHARED");
  const std::filesystem::path folder(named != nullptr && *named != '\0' ? named
                                                                        : SPM_SHARED_FOLDER);
  const std::filesystem::path meshes = folder / "meshes";
  if (!std::filesystem::is_directory(meshes)) {
    throw baker::BakeError(ExitCode::file_or_device,
                           meshes.string() +
                               ": no such folder; name the folder of shared meshes by SPM_SHARED, "
                               "or name the meshes by options");
  }
  return folder.string();
}

std::vector<ModelSource> sources_of(const std::vector<KnownMesh>& meshes,
                                    std::optional<double> tolerance) {
  const std::filesystem::path folder = std::filesystem::path(shared_folder()) / "meshes";
  std::vector<ModelSource> sources;
  sources.reserve(meshes.size());
  for (const KnownMesh& mesh : meshes) {
    sources.push_back({mesh.name, (folder / (std::string(mesh.name) + ".obj")).string(),
                       tolerance.value_or(mesh.tolerance)});
  }
  return sources;
}

std::vector<ModelSource> sources_of(const std::vector<std::string>& paths,
                                    std::optional<double> tolerance) {
  std::vector<ModelSource> sources;
  sources.reserve(paths.size());
  for (const std::string& path : paths) {
    sources.push_back({std::filesystem::path(path).stem().string(), path,
                       tolerance.value_or(bench_diagonal / 1000)});
  }
  return sources;
}

}  // namespace spm::bench
