// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "servo/scene/asset_keeper.hpp"

namespace spm::servo {

/// The loading thread: looks after the files of all assets, one after the other. One thread for
/// all, since each thread's stack is locked in memory, and takes more than most assets.
class AssetWatch {
 public:
  /// `poll`: between two rounds. No thread runs yet.
  explicit AssetWatch(std::chrono::milliseconds poll) : poll_(poll) {}
  AssetWatch(const AssetWatch&) = delete;
  AssetWatch& operator=(const AssetWatch&) = delete;
  /// Stops the thread.
  ~AssetWatch();

  /// Any thread, before or after `start`. The keeper must outlive this.
  void add(AssetKeeper& keeper);
  void start();

 private:
  void run();

  std::chrono::milliseconds poll_;
  std::mutex mutex_;  ///< guards what follows; the loop never takes it
  std::condition_variable wake_;
  bool stop_ = false;
  std::vector<AssetKeeper*> keepers_;
  std::thread thread_;
};

}  // namespace spm::servo
