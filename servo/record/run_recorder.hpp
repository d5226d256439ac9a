// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/motion/recording.hpp"
#include "servo/record/black_box.hpp"
#include "servo/record/recorded_scene.hpp"
#include "servo/record/scene_step.hpp"
#include "servo/record/tick_record.hpp"

namespace spm::servo {

/// Makes recordings of rows and of changes of the scene, in the order in which the loop made them:
/// one file of the whole run, and the black box. Follows the scene, so that a recording can begin
/// at any tick. Belongs to the collecting thread.
class RunRecorder {
 public:
  using Log = std::function<void(const std::string&)>;
  /// The assets that are served now, by number.
  using AssetsNow = std::function<std::vector<RecordedAsset>()>;

  struct Settings {
    RecordingHeader header;            ///< at the first tick, but for its scene
    ForceScene scene;                  ///< at the first tick
    std::string record;                ///< file of the whole run; empty: none
    std::string black_box;             ///< file of the black box; empty: none
    BlackBoxMemory* memory = nullptr;  ///< of the black box; null: none
    AssetsNow assets;                  ///< may be empty: those of the header
    Log warn;
  };

  /// `steps` must outlive this. Errors: file_or_device, if the file cannot be created.
  [[nodiscard]] static Result<RunRecorder> create(Settings settings, StepRing& steps);

  /// A row; the changes that came before it are taken from their ring first.
  void take(const RecordingRow& row);

  /// Completes the file, and the black box if a fault waits for it. Errors: file_or_device.
  [[nodiscard]] Result<void> finish();

  /// How often the black box was written.
  [[nodiscard]] std::uint64_t black_boxes() const { return black_box_ ? black_box_->written() : 0; }

 private:
  RunRecorder(Settings settings, StepRing& steps);
  void take(const SceneStep& step);
  void look_at_assets(std::uint64_t tick);
  void keep(const RecordedChange& change);
  void write(std::string_view part, std::uint64_t tick);
  [[nodiscard]] RecordingHeader header_now() const;

  Settings settings_;
  StepRing* steps_;
  RecordedScene scene_;  ///< as it is now
  std::optional<RecordingWriter> file_;
  std::optional<BlackBox> black_box_;
  bool full_reported_ = false;
  std::string part_;  ///< kept for its memory
};

}  // namespace spm::servo
