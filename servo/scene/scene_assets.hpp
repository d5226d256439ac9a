// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "servo/scene/asset_keeper.hpp"
#include "servo/scene/asset_watch.hpp"
#include "servo/scene/force_choice.hpp"
#include "servo/scene/tool_choice.hpp"

namespace spm::servo {

/// The error of an asset with the place, file and line, of a scene's object that names it; as it is
/// where the message begins with the place already.
[[nodiscard]] tl::unexpected<Error> at_place(const std::string& place, const Error& error);

/// The assets of a scene. Each has a slot, which hands it to the loop, and a keeper, which looks
/// after its file. Spare slots are for assets that an edited scene names. An asset that was opened
/// once stays mapped, even if no object refers to it any more.
class SceneAssets {
 public:
  /// Opens the assets of a choice. No thread runs yet. `each` is for every keeper; its path, what
  /// it accepts and samples are filled in. `room`: of the choice's tool, if it has one. Errors:
  /// those of AssetKeeper::open and of check_asset.
  [[nodiscard]] static Result<std::unique_ptr<SceneAssets>> open(KeeperOptions each,
                                                                 ForceChoice choice,
                                                                 std::size_t spare = 0,
                                                                 const ToolRoom& room = {});
  SceneAssets(const SceneAssets&) = delete;
  SceneAssets& operator=(const SceneAssets&) = delete;
  /// Stops the watch. The loop must have ended.
  ~SceneAssets() = default;

  /// All slots, the spare ones after the others.
  [[nodiscard]] std::vector<AssetSlot*> slots() const;
  /// The assets that `open` opened; valid until `watch`.
  [[nodiscard]] std::vector<const AssetView*> views() const;
  /// The tool of the scene, as `open` sampled it; null where the tool is a point or a ball. Valid
  /// until `watch`.
  [[nodiscard]] SampledTool* tool() const;
  /// Starts the thread that watches all files.
  void watch();

  /// One thread beside the loop: the index of the slot of a file, which is opened if it is new.
  /// Errors: those of AssetKeeper::open; unsupported, if no slot is left.
  [[nodiscard]] Result<std::size_t> number_of(const std::string& path);
  /// The same thread: refuses a scene that an asset, as it is now, cannot serve.
  [[nodiscard]] Result<void> check(const ForceChoice& choice) const;
  /// The same thread: sets the scene that assets which are loaded again have to serve from now on.
  void serve(ForceChoice choice);

  /// Any thread: the paths of all assets that were opened, by the indices of their slots.
  [[nodiscard]] std::vector<std::string> paths() const;
  [[nodiscard]] std::vector<KeeperReport> reports() const;
  /// The scene that is served; its assets are given by the indices of their slots.
  [[nodiscard]] ForceChoice choice() const;

 private:
  SceneAssets(KeeperOptions each, ForceChoice choice, std::size_t slots, const ToolRoom& room);
  [[nodiscard]] Result<void> open_next(const std::string& path);

  KeeperOptions each_;
  ToolRoom room_;
  std::vector<std::unique_ptr<AssetSlot>> slots_;  ///< outlive the keepers
  mutable std::mutex mutex_;                       ///< guards what follows; the loop never takes it
  ForceChoice choice_;
  std::vector<std::string> paths_;
  std::vector<std::unique_ptr<AssetKeeper>> keepers_;  ///< one for each path
  AssetWatch watch_;                                   ///< of them all; ends first
};

}  // namespace spm::servo
