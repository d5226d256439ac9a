// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/asset_watch.hpp"

namespace spm::servo {

AssetWatch::~AssetWatch() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void AssetWatch::add(AssetKeeper& keeper) {
  const std::lock_guard lock(mutex_);
  keepers_.push_back(&keeper);
}

void AssetWatch::start() { thread_ = std::thread(&AssetWatch::run, this); }

void AssetWatch::run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, poll_, [this] { return stop_; })) {
    // Others may be added meanwhile, none is taken away.
    for (std::size_t k = 0; k < keepers_.size() && !stop_; ++k) {
      AssetKeeper* const keeper = keepers_[k];
      lock.unlock();
      keeper->look();
      lock.lock();
    }
  }
}

}  // namespace spm::servo
