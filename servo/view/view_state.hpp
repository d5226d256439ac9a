// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "servo/client/spm_client.h"

namespace spm::servo {

/// What the view says of the daemon, beside enum spm_client_daemon: it was not found.
inline constexpr int no_daemon = 4;

struct ViewDevice {
  std::string name;
  double bare_border = 0, stabilized_border = 0;  ///< N/m, at which it shakes; 0: not known
  spm_client_device state{};
  spm_client_device_counts counts{};
};

struct ViewObject {
  std::string name;
  spm_client_object state{};
  spm_client_feel feel{};
};

/// How far the mesh of an asset has come.
enum class MeshState : std::uint8_t { loading, ready, failed };

struct ViewAsset {
  std::string name, path;  ///< the path is absolute; empty where it is not known
  MeshState mesh = MeshState::loading;
  std::string error;         ///< why there is no mesh
  std::uint64_t number = 0;  ///< of the mesh; a file that was baked again has another one
  double cell = 0;           ///< m, of the grid that the mesh was made on
  std::uint64_t triangles = 0;
};

struct ViewCause {
  std::string name, cure;
};

/// All that a page is told of a daemon, as libspm_client reads it.
struct ViewState {
  int daemon = no_daemon;  ///< enum spm_client_daemon, or no_daemon
  std::string message;     ///< why there is none
  double age = -1;         ///< s since the last tick; below 0: none
  spm_client_info info{};
  spm_client_tick tick{};
  spm_client_loop loop{};
  std::vector<ViewDevice> devices;
  std::vector<ViewObject> objects;
  std::vector<ViewAsset> assets;
  std::vector<ViewCause> causes;
  std::vector<spm_client_contact> contacts;
  std::vector<spm_client_application> applications;
};

/// The part of a state that changes with each tick, as the page reads it: numbers of 64 bits. Its
/// first places are `frame_head`; then each device has `frame_device` places, each object
/// `frame_object`, each contact `frame_contact`. page/frame.js reads it in the same order.
/// `before`: the loop a frame earlier, for what happened since. The places of `frame_hand` and
/// `frame_echo` are each page's own.
[[nodiscard]] std::vector<double> frame_of(const ViewState& state, const spm_client_loop& before);

inline constexpr std::size_t frame_head = 20, frame_device = 55, frame_object = 18,
                             frame_contact = 12;
/// Whether the page that gets the frame leads a hand (1), another one does (2), or none (0); and
/// the number of the page's last command for a hand.
inline constexpr std::size_t frame_hand = 16, frame_echo = 17;

/// The part that seldom changes, as JSON: names, causes with their cures, assets, how objects feel,
/// applications.
[[nodiscard]] std::string scene_json(const ViewState& state);

/// The scene as it is now, as a file that `spm-servo run --scene` takes (formats/scene/KEYS.md).
/// Paths of assets are absolute.
[[nodiscard]] std::string scene_toml(const ViewState& state);

}  // namespace spm::servo
