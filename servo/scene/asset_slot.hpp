// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "common/asset/asset_view.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "servo/force/sampled_tool.hpp"

namespace spm::servo {

/// An asset as the loop sees it. `mapping` may be null for an asset that lives in memory.
struct ServedAsset {
  const AssetView* view = nullptr;
  const MappedAsset* mapping = nullptr;
  /// The samples, where the asset is a tool of the scene; the loop's own. Where hands have tools of
  /// their own the first that is made of it.
  SampledTool* tool = nullptr;
  std::vector<SampledTool*> own_tools{};  ///< by hands that have tools of their own; may be null

  [[nodiscard]] SampledTool* tool_of(std::size_t hand) const noexcept {
    if (own_tools.empty()) return tool;
    return hand < own_tools.size() ? own_tools[hand] : nullptr;
  }

  [[nodiscard]] bool lost() const noexcept { return mapping != nullptr && mapping->lost(); }

  /// How far the farthest corner of its bounding box is from its origin, m, asset's frame.
  [[nodiscard]] double reach() const noexcept {
    if (mapping == nullptr) {
      const Extent extent = extent_of(*view);
      return farthest(extent.low, extent.low + extent.size);
    }
    return farthest(mapping->metadata().box_min, mapping->metadata().box_max);
  }

 private:
  static double farthest(const Vector3& low, const Vector3& high) noexcept {
    return low.cwiseAbs().cwiseMax(high.cwiseAbs()).norm();
  }
};

/// Hands assets from the loading thread to the loop without a lock, with one thread on each side.
/// The loop announces what it uses (a hazard pointer), so that the loading thread knows when the
/// old asset may be freed.
class AssetSlot {
 public:
  /// Loading thread: offers an asset, or none (null).
  void offer(const ServedAsset* asset) noexcept { offered_.store(asset); }

  /// Loading thread: true if the loop neither uses the asset nor can still take it up. The asset
  /// must have been replaced by another `offer`.
  [[nodiscard]] bool released(const ServedAsset* asset) const noexcept {
    return in_use_.load() != asset;
  }

  /// Loop: the asset to use until the next call, or null.
  [[nodiscard]] const ServedAsset* acquire() noexcept {
    const ServedAsset* asset = offered_.load();
    for (int attempt = 0; attempt < max_attempts; ++attempt) {
      in_use_.store(asset);
      // An offer that changed before it was announced may already have been freed.
      const ServedAsset* now = offered_.load();
      if (now == asset) return asset;
      asset = now;
    }
    in_use_.store(nullptr);
    return nullptr;
  }

  /// Loop: from now on uses no asset.
  void release() noexcept { in_use_.store(nullptr); }

 private:
  static constexpr int max_attempts = 4;  // offers come seconds apart

  std::atomic<const ServedAsset*> offered_{nullptr};
  std::atomic<const ServedAsset*> in_use_{nullptr};
};

}  // namespace spm::servo
