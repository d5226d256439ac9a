// SPDX-License-Identifier: Apache-2.0
#include "servo/app/app_info.hpp"

#include <algorithm>
#include <cstring>

#include "servo/app/app_state.hpp"
#include "servo/client/spm_client.h"
#include "servo/shared/fixed_text.hpp"

namespace spm::servo {

namespace {

// The numbers of these are known to applications.
static_assert(force_off_count <= SPM_MAX_CAUSES);
static_assert(static_cast<int>(ForceOff::none) == SPM_CLIENT_FORCE_ON);
static_assert(static_cast<int>(ForceOff::starting) == SPM_CLIENT_OFF_STARTING);
static_assert(static_cast<int>(ForceOff::asset_lost) == SPM_CLIENT_OFF_ASSET_LOST);
static_assert(static_cast<int>(ForceOff::not_a_number) == SPM_CLIENT_OFF_NOT_A_NUMBER);
static_assert(static_cast<int>(ForceOff::device_fault) == SPM_CLIENT_OFF_DEVICE_FAULT);
static_assert(static_cast<int>(ForceOff::stopping) == SPM_CLIENT_OFF_STOPPING);
static_assert(static_cast<int>(ForceOff::device_silent) == SPM_CLIENT_OFF_DEVICE_SILENT);
static_assert(static_cast<int>(ForceOff::device_gone) == SPM_CLIENT_OFF_DEVICE_GONE);
static_assert(static_cast<int>(ForceOff::not_homed) == SPM_CLIENT_OFF_NOT_HOMED);
static_assert(static_cast<int>(ForceOff::jumped) == SPM_CLIENT_OFF_JUMPED);
static_assert(static_cast<int>(ForceOff::clutched) == SPM_CLIENT_OFF_CLUTCHED);
static_assert(static_cast<int>(ForceOff::outside_workspace) == SPM_CLIENT_OFF_OUTSIDE_WORKSPACE);
static_assert(static_cast<int>(ForceOff::application_silent) == SPM_CLIENT_OFF_APPLICATION_SILENT);
static_assert(static_cast<int>(ForceOff::stalled) == SPM_CLIENT_OFF_STALLED);
static_assert(static_cast<int>(ForceOff::unacknowledged) == SPM_CLIENT_OFF_UNACKNOWLEDGED);
static_assert(static_cast<int>(ForceOff::not_enabled) == SPM_CLIENT_OFF_NOT_ENABLED);
static_assert(static_cast<int>(ForceOff::runaway) == SPM_CLIENT_OFF_RUNAWAY);
static_assert(static_cast<int>(ForceOff::unconfirmed) == SPM_CLIENT_OFF_UNCONFIRMED);
static_assert(force_off_count == 18,
              "name a new cause in spm_client.h and spm_client_library.py too");
static_assert(static_cast<int>(DeviceHealth::ok) == SPM_CLIENT_HEALTH_OK);
static_assert(static_cast<int>(DeviceHealth::fault) == SPM_CLIENT_HEALTH_FAULT);
static_assert(static_cast<int>(DeviceHealth::silent) == SPM_CLIENT_HEALTH_SILENT);
static_assert(static_cast<int>(DeviceHealth::gone) == SPM_CLIENT_HEALTH_GONE);
static_assert(static_cast<int>(DeviceHealth::not_homed) == SPM_CLIENT_HEALTH_NOT_HOMED);
static_assert(static_cast<int>(DeviceHealth::unconfirmed) == SPM_CLIENT_HEALTH_UNCONFIRMED);

/// Copies names. Returns how many there was room for.
template <std::size_t Most>
std::uint32_t copy_names(char (&to)[Most][SPM_NAME_BYTES], const std::vector<std::string>& from) {
  const std::size_t count = std::min(Most, from.size());
  for (std::size_t i = 0; i < count; ++i) copy_text(to[i], from[i]);
  return static_cast<std::uint32_t>(count);
}

}  // namespace

std::unique_ptr<spm_shared_info> info_of(const AppNames& names) {
  auto info = std::make_unique<spm_shared_info>();
  std::memset(info.get(), 0, sizeof *info);
  info->device_count = copy_names(info->devices, names.devices);
  info->asset_count = copy_names(info->assets, names.assets);
  for (std::size_t i = 0; i < info->asset_count && i < names.asset_paths.size(); ++i) {
    // Half a path would lead to another file.
    if (names.asset_paths[i].size() < SPM_PATH_BYTES) {
      copy_text(info->asset_paths[i], names.asset_paths[i]);
    }
  }
  for (std::size_t i = 0; i < info->device_count; ++i) {
    if (i < names.bare_borders.size()) info->bare_borders[i] = names.bare_borders[i];
    if (i < names.stabilized_borders.size()) {
      info->stabilized_borders[i] = names.stabilized_borders[i];
    }
  }
  info->object_count = copy_names(info->objects, names.objects);
  info->cause_count = force_off_count;
  for (std::size_t i = 0; i < force_off_count; ++i) {
    copy_text(info->causes[i].name, to_string(static_cast<ForceOff>(i)));
    copy_text(info->causes[i].cure, cure_of(static_cast<ForceOff>(i)));
  }
  return info;
}

}  // namespace spm::servo
