// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "servo/foxglove/foxglove_client.hpp"
#include "servo/view/view_desk.hpp"
#include "servo/view/view_state.hpp"

namespace spm::servo {

/// What is on its way to one Foxglove viewer. One that is slow gets the newest message of each
/// channel, and all of the log's.
class FoxgloveViewer {
 public:
  /// `wake` is called when there is something to send.
  explicit FoxgloveViewer(std::function<void()> wake);

  /// Tells it of a tick: its samples, one a device.
  void give(const std::vector<FoxgloveChannel>& channels, const std::vector<HandSample>& samples,
            const std::vector<std::string>& causes_before);
  void hear(const std::string& text);

  [[nodiscard]] bool next(ViewPage::Message& message);
  [[nodiscard]] bool is_hopeless() const noexcept { return texts_.size() > most_texts; }
  void end() {
    ended_ = true;
    wake_();
  }
  [[nodiscard]] bool has_ended() const noexcept { return ended_; }

 private:
  static constexpr std::size_t most_texts = 256;
  std::function<void()> wake_;
  bool ended_ = false;
  FoxgloveClient client_;
  std::deque<ViewPage::Message> texts_;            ///< and messages of the log
  std::map<std::uint32_t, std::string> messages_;  ///< the newest of each subscription
};

/// Hands each new tick to all viewers. Belongs to one thread.
class FoxgloveDesk {
 public:
  void join(const std::shared_ptr<FoxgloveViewer>& viewer) { viewers_.push_back(viewer); }
  void leave(const FoxgloveViewer& viewer);
  [[nodiscard]] bool is_full() const noexcept { return viewers_.size() >= most_viewers; }
  [[nodiscard]] bool is_watched() const noexcept { return !viewers_.empty(); }

  /// Tells all viewers of a state, where its tick is a new one.
  void look(const ViewState& state);

 private:
  static constexpr std::size_t most_viewers = 16;
  std::vector<std::shared_ptr<FoxgloveViewer>> viewers_;
  std::vector<FoxgloveChannel> channels_;
  std::vector<bool> has_tool_;
  std::vector<std::string> causes_;  ///< of the tick before, a device each
  std::uint64_t tick_ = 0;
};

/// The samples of a state, one a device.
[[nodiscard]] std::vector<HandSample> samples_of(const ViewState& state);

}  // namespace spm::servo
