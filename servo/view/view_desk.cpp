// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_desk.hpp"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

namespace spm::servo {

namespace {

std::string told(const char* kind, const std::string& text) {
  return nlohmann::json{{"t", kind}, {"text", text}}.dump(-1, ' ', false,
                                                          nlohmann::json::error_handler_t::replace);
}

}  // namespace

void ViewPage::give_frame(const std::vector<double>& frame, int hand) {
  frame_ = frame;
  if (frame_.size() >= frame_head) {
    frame_[frame_hand] = hand;
    frame_[frame_echo] = echo;
  }
  wake_();
}

void ViewPage::give_text(std::string text) {
  texts_.push_back(std::move(text));
  wake_();
}

bool ViewPage::next(Message& message) {
  if (!texts_.empty()) {
    message = {false, std::move(texts_.front())};
    texts_.pop_front();
    return true;
  }
  if (frame_.empty() || unseen_ >= most_unseen) return false;
  ++unseen_;
  message.is_frame = true;
  message.bytes.resize(frame_.size() * sizeof(double));
  std::memcpy(message.bytes.data(), frame_.data(), message.bytes.size());
  frame_.clear();
  return true;
}

void ViewDesk::leave(const ViewPage& page) {
  if (leader_ == &page) {
    static_cast<void>(feed_.let_go(led_));
    leader_ = nullptr;
  }
  std::erase_if(pages_, [&](const auto& other) { return other.get() == &page; });
}

bool ViewDesk::is_led_by_other(const ViewPage& page) const {
  return leader_ != nullptr && leader_ != &page && Clock::now() < leads_until_;
}

int ViewDesk::hand_of(const ViewPage& page) const {
  const bool led = leader_ != nullptr && Clock::now() < leads_until_;
  if (led) return leader_ == &page ? 1 : 2;
  const auto& devices = feed_.state().devices;
  const bool by_others = std::any_of(devices.begin(), devices.end(), [](const ViewDevice& device) {
    return device.state.hand == SPM_CLIENT_HAND_LED;
  });
  return by_others && leader_ != &page ? 2 : 0;
}

void ViewDesk::look() {
  feed_.look();
  const std::string refusal = feed_.refusal();
  // A list of its own: a page that is woken may leave.
  const auto pages = pages_;
  for (const auto& page : pages) {
    if (page->scene_number != feed_.scene_number()) {
      page->scene_number = feed_.scene_number();
      page->give_text(feed_.scene());
    }
    if (!refusal.empty()) page->give_text(told("refused", refusal));
    page->give_frame(feed_.frame(), hand_of(*page));
  }
}

void ViewDesk::hear(ViewPage& page, const std::string& text) {
  const auto wish = read_wish(text);
  if (!wish) return page.give_text(told("refused", "the view did not understand its page: reload"));
  const std::string problem =
      std::visit([&](const auto& known) { return follow(page, known); }, *wish);
  if (!problem.empty()) page.give_text(told("refused", problem));
}

std::string ViewDesk::follow(ViewPage& page, const LeadWish& wish) {
  if (is_led_by_other(page)) return "another page leads this hand: this one watches";
  std::string problem = feed_.lead(wish.device, wish.hand);
  if (!problem.empty()) return problem;
  leader_ = &page;
  led_ = wish.device;
  leads_until_ = Clock::now() + hand_hold;
  page.echo = wish.number;
  return "";
}

std::string ViewDesk::follow(ViewPage& page, const FreeWish& wish) {
  if (leader_ != &page) return "";
  leader_ = nullptr;
  return feed_.let_go(wish.device);
}

std::string ViewDesk::follow(ViewPage& /*page*/, const FeelWish& wish) {
  return feed_.feel(wish.object, wish.feel);
}

std::string ViewDesk::follow(ViewPage& /*page*/, const MethodWish& wish) {
  return feed_.choose_method(wish.object, wish.method);
}

std::string ViewDesk::follow(ViewPage& /*page*/, const StabilizeWish& wish) {
  return feed_.stabilize(wish.on);
}

std::string ViewDesk::follow(ViewPage& /*page*/, const CapWish& wish) {
  return feed_.cap(wish.device, wish.newtons);
}

std::string ViewDesk::follow(ViewPage& /*page*/, const AcknowledgeWish& wish) {
  return feed_.acknowledge(wish.device);
}

std::string ViewDesk::follow(ViewPage& page, const SeenWish& /*wish*/) {
  page.see();
  return "";
}

}  // namespace spm::servo
