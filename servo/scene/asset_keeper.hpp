// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "servo/scene/asset_slot.hpp"

namespace spm::servo {

struct KeeperOptions {
  std::string path;
  MapMode mode = MapMode::file;
  bool lock = true;                      ///< lock the mapping in memory, if that is permitted
  std::chrono::milliseconds poll{5};     ///< between two looks at the file
  std::chrono::milliseconds retry{100};  ///< after a failed reload; doubles up to `longest_retry`
  std::chrono::milliseconds longest_retry{1000};
  /// Refuses an intact asset that the loop cannot serve with its settings. May be empty.
  std::function<Result<void>(const AssetMetadata&)> accept;
  /// Makes the samples of an asset that is a tool, whenever its file is loaded; it is refused where
  /// that fails. One for all hands, or one for each, null where that holds another. Called on the
  /// loading thread. Empty for all other assets.
  std::function<Result<std::vector<std::unique_ptr<SampledTool>>>(const AssetView&)> sample;
  /// Called with a sentence for a person, on the loading thread. May be empty.
  std::function<void(const std::string&)> warn;
};

/// The samples of a tool on its finest level; none of a `full` tool.
struct ToolReport {
  std::size_t samples = 0;
  double spacing = 0;  ///< m of the world, between them
};

/// What a report says of an asset.
struct KeeperReport {
  std::string content_sha256;
  AssetMetadata metadata;
  AssetBytes bytes;
  std::uint64_t resident_bytes = 0;  ///< that answers may come from
  double open_seconds = 0;           ///< to map and check the file, and to sample a tool
  std::vector<ToolReport> tools;     ///< of the scene's, in its order; empty: it is none of them
  std::uint64_t tool_bytes = 0;      ///< of its samples, and what hands remember of them
  bool locked = false;
  bool serving = false;
  std::uint64_t losses = 0;
  std::uint64_t reloads = 0;
};

/// Opens and validates an asset, hands it to the loop and looks after its file (AssetWatch). When
/// the mapped bytes are truncated or edited, it takes the asset away from the loop, tries to load
/// the file again until it is intact, and hands it over again. Where another file has the name now,
/// as after a bake, or none has it, the mapped bytes are as they were, because the mapping holds
/// their file: they are served until new ones are validated. So is a `sealed` asset in any case. An
/// old mapping is freed when the loop no longer uses it.
class AssetKeeper {
 public:
  /// Opens the asset and offers it to the loop. Errors: those of
  /// MappedAsset::open and of `accept`.
  [[nodiscard]] static Result<std::unique_ptr<AssetKeeper>> open(KeeperOptions options,
                                                                 AssetSlot& slot);
  AssetKeeper(const AssetKeeper&) = delete;
  AssetKeeper& operator=(const AssetKeeper&) = delete;
  /// The loop must have ended, and nothing looks any more.
  ~AssetKeeper();

  /// The asset that `open` offered. Valid until `look`.
  [[nodiscard]] const AssetView& view() const { return *current_->served.view; }

  /// The samples that `open` made; null where the asset is not the tool. Valid until `look`.
  [[nodiscard]] SampledTool* tool() const { return current_->served.tool; }

  /// The loading thread: looks once whether the file has changed, and loads it again where it has
  /// and that is due.
  void look();

  /// May be called on any thread at any time.
  [[nodiscard]] KeeperReport report() const;

 private:
  /// A mapping, and the record that describes it to the loop.
  struct Holding {
    std::unique_ptr<MappedAsset> asset;
    std::vector<std::unique_ptr<SampledTool>> tools;  ///< empty where the asset is none
    ServedAsset served;
    double open_seconds = 0;
  };

  AssetKeeper(KeeperOptions options, AssetSlot& slot);
  [[nodiscard]] Result<std::unique_ptr<Holding>> load() const;
  void withdraw(AssetState state);
  void try_reload();
  void install(std::unique_ptr<Holding> holding);
  void free_released();
  void warn(const std::string& message) const;
  [[nodiscard]] bool damaged(AssetState state) const;

  KeeperOptions options_;
  AssetSlot& slot_;
  std::unique_ptr<Holding> current_;
  std::vector<std::unique_ptr<Holding>> retired_;
  bool reload_wanted_ = false;
  std::chrono::steady_clock::time_point next_try_{};
  std::chrono::milliseconds wait_{0};
  std::string last_refusal_;

  mutable std::mutex mutex_;  ///< guards the report; the loop never takes it
  KeeperReport report_;
};

}  // namespace spm::servo
