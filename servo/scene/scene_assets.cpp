// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/scene_assets.hpp"

#include <algorithm>
#include <utility>

namespace spm::servo {

tl::unexpected<Error> at_place(const std::string& place, const Error& error) {
  return fail(error.code, error.message.starts_with(place) ? error.message : place + error.message);
}

Result<std::unique_ptr<SceneAssets>> SceneAssets::open(KeeperOptions each, ForceChoice choice,
                                                       std::size_t spare, const ToolRoom& room) {
  const std::vector<std::string> paths = choice.assets;
  std::unique_ptr<SceneAssets> assets(
      new SceneAssets(std::move(each), std::move(choice), paths.size() + spare, room));
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (auto opened = assets->open_next(paths[i]); !opened) {
      return at_place(place_of_asset(assets->choice_, i), opened.error());
    }
  }
  return assets;
}

SceneAssets::SceneAssets(KeeperOptions each, ForceChoice choice, std::size_t slots,
                         const ToolRoom& room)
    : each_(std::move(each)), room_(room), choice_(std::move(choice)), watch_(each_.poll) {
  for (std::size_t i = 0; i < slots; ++i) slots_.push_back(std::make_unique<AssetSlot>());
}

Result<void> SceneAssets::open_next(const std::string& path) {
  const std::size_t number = keepers_.size();
  KeeperOptions options = each_;
  options.path = path;
  options.accept = [this, number](const AssetMetadata& metadata) {
    return check_asset(metadata, choice(), number);
  };
  // Which assets are tools, and how they are sampled, is fixed while the daemon runs.
  if (const ForceScene scene = choice().scene; is_tool(scene, number)) {
    options.sample = [scene, number, room = room_](const AssetView& asset) {
      return sample_tools(asset, number, scene, room);
    };
  }
  auto opened = AssetKeeper::open(std::move(options), *slots_[number]);
  if (!opened) return tl::make_unexpected(std::move(opened.error()));
  const std::lock_guard lock(mutex_);
  paths_.push_back(path);
  keepers_.push_back(std::move(*opened));
  watch_.add(*keepers_.back());
  return {};
}

std::vector<AssetSlot*> SceneAssets::slots() const {
  std::vector<AssetSlot*> list;
  for (const auto& slot : slots_) list.push_back(slot.get());
  return list;
}

std::vector<const AssetView*> SceneAssets::views() const {
  std::vector<const AssetView*> list;
  for (const auto& keeper : keepers_) list.push_back(&keeper->view());
  return list;
}

SampledTool* SceneAssets::tool() const {
  for (const auto& keeper : keepers_) {
    if (keeper->tool() != nullptr) return keeper->tool();
  }
  return nullptr;
}

void SceneAssets::watch() { watch_.start(); }

Result<std::size_t> SceneAssets::number_of(const std::string& path) {
  const auto found = std::find(paths_.begin(), paths_.end(), path);
  if (found != paths_.end()) return static_cast<std::size_t>(found - paths_.begin());
  if (keepers_.size() == slots_.size()) {
    return fail(ExitCode::unsupported,
                path +
                    ": no more new assets can be taken up while the daemon runs; start it again "
                    "with this scene");
  }
  if (auto opened = open_next(path); !opened) {
    return tl::make_unexpected(std::move(opened.error()));
  }
  return keepers_.size() - 1;
}

Result<void> SceneAssets::check(const ForceChoice& choice) const {
  for (std::size_t i = 0; i < keepers_.size(); ++i) {
    auto checked = check_asset(keepers_[i]->report().metadata, choice, i);
    if (!checked) return checked;
  }
  return {};
}

void SceneAssets::serve(ForceChoice choice) {
  const std::lock_guard lock(mutex_);
  choice_ = std::move(choice);
}

std::vector<std::string> SceneAssets::paths() const {
  const std::lock_guard lock(mutex_);
  return paths_;
}

std::vector<KeeperReport> SceneAssets::reports() const {
  const std::lock_guard lock(mutex_);
  std::vector<KeeperReport> list;
  for (const auto& keeper : keepers_) list.push_back(keeper->report());
  return list;
}

ForceChoice SceneAssets::choice() const {
  const std::lock_guard lock(mutex_);
  return choice_;
}

}  // namespace spm::servo
