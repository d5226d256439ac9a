// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "servo/scene/force_choice.hpp"
#include "servo/scene/scene_assets.hpp"
#include "servo/scene/scene_edit.hpp"

namespace spm::servo {

/// A scene that is served.
struct ServedScene {
  ForceChoice choice;              ///< its assets are given by the indices of their slots
  std::vector<std::uint64_t> ids;  ///< of its objects, as applications know them
};

struct SceneKeeperOptions {
  ForceOptions force;                  ///< as at the start; its scene is the file that is watched
  std::chrono::milliseconds poll{20};  ///< between two looks at the file
  /// after a refusal that a change of another file may cure
  std::chrono::milliseconds retry{1000};
  /// Called with one sentence for a person: `tell` says what was taken up, `warn` what was not and
  /// why. May be empty.
  std::function<void(const std::string&)> tell, warn;
  /// Called each time that the loop has taken up an edit. May be empty.
  std::function<void(const ServedScene&)> taken_up;
  // All three are called on the watching thread.
};

/// Which file a path names, and its state.
struct FileStamp {
  bool is_there = false;
  std::uint64_t device = 0, inode = 0;
  std::int64_t size = 0;        ///< bytes
  std::int64_t written_ns = 0;  ///< when its content was written
  std::int64_t changed_ns = 0;  ///< when anything of it changed

  [[nodiscard]] bool operator==(const FileStamp&) const = default;
};

/// The thread that watches a scene's file while it is served. When the file was edited, or another
/// file was renamed to it, it reads it as at the start, opens assets that are new, and hands the
/// differences to the loop. An edit that is not acceptable is reported once, and the scene stays as
/// it was. Changes of device, tool and workspace need a restart. A file that is still being written
/// is left alone until two looks find it unchanged.
class SceneKeeper {
 public:
  /// `assets` must serve this scene, and must outlive this.
  SceneKeeper(SceneKeeperOptions options, SceneAssets& assets);
  SceneKeeper(const SceneKeeper&) = delete;
  SceneKeeper& operator=(const SceneKeeper&) = delete;
  /// Stops the thread. The loop must have ended.
  ~SceneKeeper();

  /// The slot that hands edits to the loop.
  [[nodiscard]] SceneEditSlot& edits() noexcept { return slot_; }
  /// Starts the thread.
  void watch();

 private:
  void run();
  void look();
  void try_scene(bool first);
  [[nodiscard]] Result<ForceChoice> read_edited();
  void offer(const SceneDifference& difference, ForceChoice edited);
  void finish(EditAnswer answer);
  void refuse(const std::string& message);

  SceneAssets& assets_;
  SceneEditSlot slot_;
  SceneKeeperOptions options_;
  ServedScene served_;
  // What was offered to the loop and is not answered yet:
  SceneEdit edit_;
  ServedScene next_;
  std::string change_;  ///< the edit, in words

  FileStamp seen_;                  ///< at the last look
  std::optional<FileStamp> tried_;  ///< what was read last
  std::chrono::steady_clock::time_point next_try_{};
  std::string last_refusal_;
  bool retry_wanted_ = false;
  bool offered_ = false;  ///< an edit, to the loop

  std::mutex mutex_;  ///< guards the members below; the loop never takes it
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace spm::servo
