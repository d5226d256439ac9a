// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/entry_check.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "baker/base/bake_error.hpp"
#include "baker/verify/verify.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/files/sha256.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t places = 4000;

tl::unexpected<Error> refused(const std::string& why) { return fail(ExitCode::invalid_input, why); }

/// A file in memory that vanishes with its owner.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes)
      : descriptor_(::memfd_create("spm-entry", MFD_CLOEXEC)) {
    const char* at = bytes.data();
    std::size_t left = bytes.size();
    while (descriptor_ >= 0 && left > 0) {
      const ssize_t count = ::write(descriptor_, at, left);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      at += count;
      left -= static_cast<std::size_t>(count);
    }
    whole_ = descriptor_ >= 0 && left == 0;
  }
  ~MemoryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] bool whole() const { return whole_; }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
  bool whole_ = false;
};

/// Whether a number that was asked for is what the asset has; an option that was left open fits.
bool same(const Json& asked, double found) { return asked.is_null() || asked == Json(found); }

/// What the asset says of itself against what was asked for.
Result<void> check_metadata(const AssetMetadata& metadata, const Json& parts, bool inexact) {
  const char* form = metadata.form == AssetForm::full ? "full" : "sparse";
  if (parts["mesh"] != metadata.mesh_sha256) return refused("its asset is of another mesh");
  if (parts["form"] != form || !same(parts["max_depth"], metadata.band.max_depth) ||
      !same(parts["margin"], metadata.band.margin) ||
      !same(parts["probe_radius"], metadata.probe_radius) ||
      !same(parts["unit"], metadata.mesh_unit)) {
    return refused("its asset was baked with other options");
  }
  if (metadata.form == AssetForm::full) return {};
  const Json& asked = parts["tolerance"];
  if (!metadata.tolerance || (asked.is_number() && *metadata.tolerance > asked.get<double>())) {
    return refused("its asset promises less than was asked for");
  }
  if (inexact) return {};
  if (!metadata.tolerance_met || !metadata.certified || *metadata.certified > *metadata.tolerance) {
    return refused("its asset has no certificate that its tolerance is met");
  }
  return {};
}

/// Its answers against the mesh.
Result<void> check_answers(const MappedAsset& asset, const BuildRequest& request) {
  VerifyOptions options;
  options.samples = places;
  options.seed = request.bake.seed;
  options.threads = request.bake.threads;
  try {
    if (!verify_asset(asset.view(), asset.metadata(), request.mesh, options).passed()) {
      return refused("its asset misses what it promises");
    }
  } catch (const BakeError& problem) {
    return refused(problem.what());
  }
  return {};
}

}  // namespace

Result<void> check_entry(const CacheEntry& entry, const Json& parts, const BuildRequest& request) {
  if (entry.parts != parts) return refused("it is that of another key");
  if (sha256_bytes(entry.asset) != entry.asset_sha256) {
    return refused("the checksum of its asset is wrong");
  }
  const MemoryFile file(entry.asset);
  if (!file.whole()) return refused(std::string("no memory to check it: ") + std::strerror(errno));
  const auto asset = MappedAsset::open(file.path());
  if (!asset) return refused("its asset is not intact: " + asset.error().message);
  Result<void> fits = check_metadata((*asset)->metadata(), parts, request.allow_inexact);
  if (!fits || request.allow_inexact) return fits;
  return check_answers(**asset, request);
}

}  // namespace spm::baker
