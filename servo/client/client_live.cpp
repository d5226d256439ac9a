// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "servo/client/client.hpp"
#include "servo/client/spm_client.h"
#include "servo/client/state_reader.hpp"

namespace {

using namespace spm::servo;

spm_client_feel public_feel(const spm_shared_object& from) noexcept {
  spm_client_feel to{};
  to.method = from.method;
  to.stabilized = from.stabilized;
  to.stiffness = from.stiffness;
  to.friction_stick = from.friction_stick;
  to.friction_slide = from.friction_slide;
  to.damping = from.damping;
  to.texture_amplitude = from.texture_amplitude;
  to.texture_wavelength = from.texture_wavelength;
  to.texture_seed = from.texture_seed;
  return to;
}

}  // namespace

int spm_client_read_feel(const spm_client* client, uint64_t object, spm_client_feel* feel) {
  if (client == nullptr || feel == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  spm_shared_object found;
  const int result = read_tick(*client, [&](const auto& snapshot) {
    for (std::uint32_t i = 0; i < object_count(snapshot); ++i) {
      if (load_relaxed(snapshot.objects[i].id) != object) continue;
      found = load_record(snapshot.objects[i]);
      return true;
    }
    return false;
  });
  return result == SPM_CLIENT_OK ? give(feel, public_feel(found)) : result;
}

int spm_client_asset_path(const spm_client* client, uint32_t asset, char* path, size_t size) {
  if (client == nullptr || path == nullptr || size == 0) return SPM_CLIENT_BAD_ARGUMENT;
  path[0] = '\0';
  char text[SPM_PATH_BYTES] = {};
  bool found = false;
  const bool read = read_info(client->connection().state(), [&](const spm_shared_info& info) {
    found = asset < std::min<std::uint32_t>(load_relaxed(info.asset_count), SPM_MAX_ASSETS);
    if (found) load_words(text, info.asset_paths[asset], sizeof text);
  });
  if (!read) return SPM_CLIENT_BUSY;
  if (!found) return SPM_CLIENT_NOT_THERE;
  const std::size_t count = std::min(size - 1, strnlen(text, sizeof text - 1));
  std::memcpy(path, text, count);
  path[count] = '\0';
  return SPM_CLIENT_OK;
}

int spm_client_border(const spm_client* client, uint32_t device, double* bare, double* stabilized) {
  if (client == nullptr) return SPM_CLIENT_BAD_ARGUMENT;
  bool found = false;
  double without = 0, with = 0;
  const bool read = read_info(client->connection().state(), [&](const spm_shared_info& info) {
    found = device < std::min<std::uint32_t>(load_relaxed(info.device_count), SPM_MAX_DEVICES);
    if (!found) return;
    without = load_relaxed(info.bare_borders[device]);
    with = load_relaxed(info.stabilized_borders[device]);
  });
  if (!read) return SPM_CLIENT_BUSY;
  if (!found) return SPM_CLIENT_NOT_THERE;
  if (bare != nullptr) *bare = without;
  if (stabilized != nullptr) *stabilized = with;
  return SPM_CLIENT_OK;
}
