// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/asset_slot.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <memory>
#include <thread>
#include <vector>

namespace asset_slot_test {

using namespace spm::servo;

TEST_CASE("An asset counts as used until the loop takes another") {
  ServedAsset first, second;
  AssetSlot slot;
  slot.offer(&first);
  REQUIRE(slot.acquire() == &first);
  slot.offer(&second);
  REQUIRE_FALSE(slot.released(&first));
  REQUIRE(slot.acquire() == &second);
  REQUIRE(slot.released(&first));
}

TEST_CASE("An asset that no loop took may be freed at once") {
  ServedAsset first;
  AssetSlot slot;
  slot.offer(&first);
  slot.offer(nullptr);
  REQUIRE(slot.released(&first));
  REQUIRE(slot.acquire() == nullptr);
}

TEST_CASE("An asset is released when the loop ends") {
  ServedAsset first;
  AssetSlot slot;
  slot.offer(&first);
  REQUIRE(slot.acquire() == &first);
  slot.offer(nullptr);
  slot.release();
  REQUIRE(slot.released(&first));
}

TEST_CASE("The loop never holds an asset that was freed") {
  // `view` doubles as the mark of life: the loading side clears it when it frees.
  const spm::AssetView view;
  std::vector<std::unique_ptr<ServedAsset>> all;
  for (int i = 0; i < 2000; ++i) all.push_back(std::make_unique<ServedAsset>(ServedAsset{&view}));
  AssetSlot slot;
  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> dead{0};
  std::thread loop([&] {
    while (!stop.load()) {
      const ServedAsset* asset = slot.acquire();
      if (asset != nullptr &&
          std::atomic_ref(const_cast<ServedAsset*>(asset)->view).load() == nullptr) {
        dead.fetch_add(1);
      }
    }
    slot.release();
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    slot.offer(all[i].get());
    if (i % 3 == 0) std::this_thread::yield();
    slot.offer(nullptr);
    while (!slot.released(all[i].get())) std::this_thread::yield();
    std::atomic_ref(all[i]->view).store(nullptr);
  }
  stop.store(true);
  loop.join();
  REQUIRE(dead.load() == 0);
}

}  // namespace asset_slot_test
