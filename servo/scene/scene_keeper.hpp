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

/// A scene as it is served.
struct ServedScene {
  ForceChoice choice;              ///< its assets are numbered by the slots
  std::vector<std::uint64_t> ids;  ///< of its objects, as applications know them
};

struct SceneKeeperOptions {
  ForceOptions force;                  ///< as at the start; its scene is the file that is watched
  std::chrono::milliseconds poll{20};  ///< between two looks at the file
  std::chrono::milliseconds retry{1000};  ///< after a refusal that another file may cure
  /// Tell a person what was taken up, and what was not and why: one sentence each. May be empty.
  std::function<void(const std::string&)> tell, warn;
  /// Told each time that the loop has taken up an edit. May be empty.
  std::function<void(const ServedScene&)> taken_up;
  // All three are called on the watching thread.
};

/// Which file a path names, and in what state.
struct FileStamp {
  bool is_there = false;
  std::uint64_t device = 0, inode = 0;
  std::int64_t size = 0;        ///< bytes
  std::int64_t written_ns = 0;  ///< when its content was
  std::int64_t changed_ns = 0;  ///< when anything of it was

  [[nodiscard]] bool operator==(const FileStamp&) const = default;
};

/// The thread that watches a scene's file while it is served: reads it again when it was edited or
/// another was renamed to it, by what reads it at the start, opens assets that it names newly, and
/// hands the loop what is different. What will not do is told once, and the scene stays as it was;
/// device, tool and workspace take a restart. A file that is still being written is left alone
/// until two looks find it the same.
class SceneKeeper {
 public:
  /// The scene must be the one that `assets` serve, which must outlive this.
  SceneKeeper(SceneKeeperOptions options, SceneAssets& assets);
  SceneKeeper(const SceneKeeper&) = delete;
  SceneKeeper& operator=(const SceneKeeper&) = delete;
  /// Stops the thread. The loop must have ended.
  ~SceneKeeper();

  /// What hands edits to the loop.
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

  SceneKeeperOptions options_;
  SceneAssets& assets_;
  SceneEditSlot slot_;
  ServedScene served_;
  // What the loop was offered and has not answered yet:
  SceneEdit edit_;
  ServedScene next_;
  std::string change_;  ///< the edit, in words
  bool offered_ = false;

  FileStamp seen_;                  ///< at the last look
  std::optional<FileStamp> tried_;  ///< what was read last
  bool retry_wanted_ = false;
  std::chrono::steady_clock::time_point next_try_{};
  std::string last_refusal_;

  std::mutex mutex_;  ///< guards what follows; the loop never takes it
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace spm::servo
