// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "servo/view/view_feed.hpp"
#include "servo/view/view_wishes.hpp"

namespace spm::servo {

/// What is on its way to one page. A page says of each frame that it saw it, and gets no third
/// before: else frames would pile up on the way to a page that is slow, which would show what was
/// long ago. Such a page loses frames, never texts, and is let go where too many texts wait.
class ViewPage {
 public:
  /// `wake` is called when there is something to send.
  explicit ViewPage(std::function<void()> wake) : wake_(std::move(wake)) {}

  void give_frame(const std::vector<double>& frame, int hand);
  void give_text(std::string text);

  /// The next message; empty if there is none. `is_frame`: it is one, else a text.
  struct Message {
    bool is_frame = false;
    std::string bytes;
  };
  [[nodiscard]] bool next(Message& message);
  /// The page saw a frame.
  void see() {
    if (unseen_ > 0) --unseen_;
    wake_();
  }
  [[nodiscard]] bool is_hopeless() const noexcept { return texts_.size() > most_texts; }

  /// The page is gone: nothing more is sent.
  void end() {
    ended_ = true;
    wake_();
  }
  [[nodiscard]] bool has_ended() const noexcept { return ended_; }

  double echo = 0;                 ///< number of the last command for a hand
  std::uint64_t scene_number = 0;  ///< of the scene that the page knows

 private:
  static constexpr std::size_t most_texts = 256;
  static constexpr int most_unseen = 2;
  std::function<void()> wake_;
  bool ended_ = false;
  int unseen_ = 0;  ///< frames that were sent, of which the page said nothing yet
  std::deque<std::string> texts_;
  std::vector<double> frame_;  ///< the newest; empty once it was sent
};

/// Where pages and daemon meet: hands frames and scenes to all pages, and their wishes to the
/// daemon. One page leads a hand at a time. Belongs to one thread.
class ViewDesk {
 public:
  explicit ViewDesk(ViewFeed& feed) : feed_(feed) {}

  void join(const std::shared_ptr<ViewPage>& page) { pages_.push_back(page); }
  void leave(const ViewPage& page);
  [[nodiscard]] bool is_full() const noexcept { return pages_.size() >= most_pages; }
  [[nodiscard]] bool is_watched() const noexcept { return !pages_.empty(); }

  /// Reads the daemon and tells all pages.
  void look();
  /// Follows a page's message.
  void hear(ViewPage& page, const std::string& text);
  [[nodiscard]] const ViewFeed& feed() const noexcept { return feed_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t most_pages = 16;

  [[nodiscard]] std::string follow(ViewPage& page, const LeadWish& wish);
  [[nodiscard]] std::string follow(ViewPage& page, const FreeWish& wish);
  [[nodiscard]] std::string follow(ViewPage& page, const FeelWish& wish);
  [[nodiscard]] std::string follow(ViewPage& page, const MethodWish& wish);
  [[nodiscard]] std::string follow(ViewPage& page, const StabilizeWish& wish);
  [[nodiscard]] std::string follow(ViewPage& page, const CapWish& wish);
  [[nodiscard]] std::string follow(ViewPage& page, const AcknowledgeWish& wish);
  [[nodiscard]] static std::string follow(ViewPage& page, const SeenWish& wish);
  [[nodiscard]] int hand_of(const ViewPage& page) const;
  [[nodiscard]] bool is_led_by_other(const ViewPage& page) const;

  ViewFeed& feed_;
  std::vector<std::shared_ptr<ViewPage>> pages_;
  const ViewPage* leader_ = nullptr;
  std::uint32_t led_ = 0;  ///< the device whose hand it leads
  Clock::time_point leads_until_;
};

}  // namespace spm::servo
