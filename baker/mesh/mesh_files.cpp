// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_files.hpp"

#include <filesystem>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/gunzip.hpp"
#include "baker/mesh/mesh_reader.hpp"
#include "baker/mesh/mesh_text.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

constexpr std::string_view packed = ".gz";

}  // namespace

std::string unpacked_extension(const std::string& path) {
  const std::filesystem::path name(path);
  const std::string extension = lower_case(name.extension().string());
  return extension == packed ? lower_case(name.stem().extension().string()) : extension;
}

std::string mesh_extension(const std::string& path) {
  const std::string last = lower_case(std::filesystem::path(path).extension().string());
  return last == packed ? unpacked_extension(path) + last : last;
}

bool names_unit(const std::string& path) { return unpacked_extension(path) == ".3mf"; }

std::vector<std::string> mesh_companions(const std::string& path, bool outside_buffers) {
  const std::string extension = unpacked_extension(path);
  if (extension != ".gltf" && extension != ".glb") return {};
  const Result<std::string> bytes = read_regular_file(path, "a mesh");
  if (!bytes) return {};
  try {
    return gltf_companions(path, is_gzip(*bytes) ? gunzip(path, *bytes) : *bytes, outside_buffers);
  } catch (const BakeError&) {
    return {};
  }
}

std::string mesh_sha256(const std::string& digest,
                        const std::vector<std::string>& companion_digests) {
  if (companion_digests.empty()) return digest;
  std::string all = digest;
  for (const std::string& companion : companion_digests) all += companion;
  return sha256_bytes(all);
}

Result<std::string> mesh_sha256(const std::string& path, bool outside_buffers) {
  Result<std::string> own = sha256_file(path);
  if (!own) return own;
  std::vector<std::string> digests;
  for (const std::string& companion : mesh_companions(path, outside_buffers)) {
    Result<std::string> digest = sha256_file(companion);
    if (!digest) return digest;
    digests.push_back(std::move(*digest));
  }
  return mesh_sha256(*own, digests);
}

}  // namespace spm::baker
