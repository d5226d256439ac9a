// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/asset_keeper.hpp"

#include <algorithm>
#include <utility>

namespace spm::servo {

using std::chrono::steady_clock;

AssetKeeper::AssetKeeper(KeeperOptions options, AssetSlot& slot)
    : options_(std::move(options)), slot_(slot) {}

Result<std::unique_ptr<AssetKeeper>> AssetKeeper::open(KeeperOptions options, AssetSlot& slot) {
  std::unique_ptr<AssetKeeper> keeper(new AssetKeeper(std::move(options), slot));
  auto holding = keeper->load();
  if (!holding) return tl::make_unexpected(std::move(holding.error()));
  keeper->install(std::move(*holding));
  return keeper;
}

AssetKeeper::~AssetKeeper() { slot_.offer(nullptr); }

KeeperReport AssetKeeper::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

Result<std::unique_ptr<AssetKeeper::Holding>> AssetKeeper::load() const {
  MapOptions map;
  map.mode = options_.mode;
  map.prefault = true;
  map.lock = options_.lock;
  const auto started = steady_clock::now();
  auto asset = MappedAsset::open(options_.path, map);
  if (!asset) return tl::make_unexpected(std::move(asset.error()));
  if (options_.accept) {
    const Result<void> accepted = options_.accept((*asset)->metadata());
    if (!accepted) return tl::make_unexpected(accepted.error());
  }
  auto holding = std::make_unique<Holding>();
  if (options_.sample) {
    auto tools = options_.sample((*asset)->view());
    if (!tools) {
      return fail(tools.error().code, options_.path + ": " + tools.error().message);
    }
    holding->tools = std::move(*tools);
  }
  const std::chrono::duration<double> opened = steady_clock::now() - started;
  // Reads the whole file. This is done now, not while the file is served, when it must be watched.
  static_cast<void>((*asset)->content_sha256());
  holding->asset = std::move(*asset);
  holding->open_seconds = opened.count();
  holding->served = {&holding->asset->view(), holding->asset.get()};
  for (const auto& tool : holding->tools) {
    if (holding->tools.size() > 1) holding->served.own_tools.push_back(tool.get());
    if (holding->served.tool == nullptr) holding->served.tool = tool.get();
  }
  return holding;
}

void AssetKeeper::look() {
  free_released();
  if (current_ != nullptr) {
    // Also while another file is to be loaded: the one that is served may still be written to.
    const AssetState state = current_->asset->check_file();
    const bool is_damaged = damaged(state);
    if (is_damaged) withdraw(state);
    if (!reload_wanted_) {
      if (state == AssetState::intact && !is_damaged) return;
      reload_wanted_ = true;
      next_try_ = steady_clock::now();
      wait_ = options_.retry;
      last_refusal_.clear();
    }
  }
  if (reload_wanted_ && steady_clock::now() >= next_try_) try_reload();
}

/// Whether the bytes that are mapped are others than they were. Those of a file that lost its name
/// are not, and a sealed copy's never.
bool AssetKeeper::damaged(AssetState state) const {
  if (current_->served.lost()) return true;
  const bool is_changed = state == AssetState::truncated || state == AssetState::edited;
  return options_.mode == MapMode::file && is_changed;
}

void AssetKeeper::withdraw(AssetState state) {
  slot_.offer(nullptr);
  warn(options_.path + ": was " + to_string(state) +
       " while in use; the force is off until an intact asset is there again");
  retired_.push_back(std::move(current_));
  const std::lock_guard lock(mutex_);
  ++report_.losses;
  report_.serving = false;
}

void AssetKeeper::try_reload() {
  auto holding = load();
  if (!holding) {
    if (holding.error().message != last_refusal_) {
      last_refusal_ = holding.error().message;
      warn((current_ != nullptr ? "served on as it was, since what is there now cannot be: "
                                : "not loaded again yet: ") +
           last_refusal_);
    }
    next_try_ = steady_clock::now() + wait_;
    wait_ = std::min(2 * wait_, options_.longest_retry);
    return;
  }
  reload_wanted_ = false;
  install(std::move(*holding));
  {
    const std::lock_guard lock(mutex_);
    ++report_.reloads;
  }
  warn(options_.path + ": loaded again");
}

void AssetKeeper::install(std::unique_ptr<Holding> holding) {
  slot_.offer(&holding->served);
  if (current_ != nullptr) retired_.push_back(std::move(current_));
  current_ = std::move(holding);
  const std::lock_guard lock(mutex_);
  report_.content_sha256 = current_->asset->content_sha256();
  report_.metadata = current_->asset->metadata();
  report_.bytes = current_->asset->bytes();
  report_.resident_bytes = current_->asset->resident_bytes();
  report_.open_seconds = current_->open_seconds;
  report_.tools.clear();
  report_.tool_bytes = 0;
  for (const auto& made : current_->tools) {
    report_.tools.emplace_back();
    if (made == nullptr) continue;
    report_.tool_bytes += made->bytes();
    const auto& levels = made->samples().levels;
    if (!levels.empty()) report_.tools.back() = {levels.back().count, levels.back().spacing};
  }
  report_.locked = current_->asset->locked();
  report_.serving = true;
}

void AssetKeeper::free_released() {
  std::erase_if(retired_, [this](const std::unique_ptr<Holding>& holding) {
    return slot_.released(&holding->served);
  });
}

void AssetKeeper::warn(const std::string& message) const {
  if (options_.warn) options_.warn(message);
}

}  // namespace spm::servo
