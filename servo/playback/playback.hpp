// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/motion/recording.hpp"
#include "servo/record/recorded_scene.hpp"

namespace spm::servo {

/// An asset of a recording as it is found now.
struct PlayedAsset {
  std::string name;                    ///< of its file, without the folder
  std::string problem;                 ///< why it is not there, or is another one; or empty
  std::unique_ptr<MappedAsset> asset;  ///< null where it could not be opened
};

/// A recording, or a black box, for the eye: what happened in each tick, where the objects were,
/// and what is worth a look. Of one that was cut short it is what is whole.
class Playback {
 public:
  /// Errors: those of salvage_recording(); invalid_input, where its scene cannot be read or it has
  /// no rows. An asset that is gone is none: its object is not drawn.
  [[nodiscard]] static Result<Playback> open(const std::string& path);

  /// All that is told in words and few numbers: devices, objects, assets, causes with cures, the
  /// marks of each device, what was lost, and the names of the columns of rows().
  [[nodiscard]] nlohmann::ordered_json summary() const;

  /// The ticks of a device, little endian: their number and that of the columns (uint32), the ticks
  /// on the loop's grid (float64), then one column after the other (float32): SI units, the world's
  /// frame. Of more than `most` ticks each group of neighbours is shown by the one with the largest
  /// force.
  static constexpr std::size_t most_rows = 400'000;
  [[nodiscard]] std::string rows(std::size_t device, std::size_t most = most_rows) const;

  /// What moved in the scene, little endian, `step_numbers` float64 each: the tick before which it
  /// came, what it was (RecordedKind), the object, position (m), orientation (w first), scale,
  /// asset. An object that moves all the time is told of 60 times a second.
  static constexpr std::size_t step_numbers = 12;
  [[nodiscard]] std::string steps() const;

  [[nodiscard]] std::size_t devices() const noexcept { return recording_.header.devices.size(); }
  [[nodiscard]] const std::vector<PlayedAsset>& assets() const noexcept { return assets_; }

 private:
  Playback() = default;
  [[nodiscard]] bool holds_tool(std::size_t device) const noexcept;

  std::string name_, loss_;
  Recording recording_;
  RecordedScene scene_;  ///< before the first row
  std::vector<SceneStep> steps_;
  std::vector<PlayedAsset> assets_;
};

}  // namespace spm::servo
