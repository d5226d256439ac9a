// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cstring>

#include "servo/view/view_desk.hpp"

namespace view_page_test {

using namespace spm::servo;

namespace {

std::vector<double> frame_with(double tick) {
  std::vector<double> frame(frame_head, 0);
  frame[0] = tick;
  return frame;
}

/// The first number of the next message, which must be a frame.
double tick_of_next(ViewPage& page) {
  ViewPage::Message message;
  REQUIRE(page.next(message));
  REQUIRE(message.is_frame);
  double tick = 0;
  std::memcpy(&tick, message.bytes.data(), sizeof tick);
  return tick;
}

}  // namespace

TEST_CASE("A page that does not say that it saw frames gets two, and later the newest alone") {
  ViewPage page([] {});
  ViewPage::Message message;
  page.give_frame(frame_with(1), 0);
  CHECK(tick_of_next(page) == 1);
  page.give_frame(frame_with(2), 0);
  CHECK(tick_of_next(page) == 2);
  for (const double tick : {3.0, 4.0, 5.0}) {
    page.give_frame(frame_with(tick), 0);
    CHECK_FALSE(page.next(message));
  }
  page.see();
  CHECK(tick_of_next(page) == 5);
  page.give_text("told");
  REQUIRE(page.next(message));
  CHECK_FALSE(message.is_frame);
  CHECK(message.bytes == "told");
}

TEST_CASE("A page that sees more than it was sent gets no more frames at once for it") {
  ViewPage page([] {});
  ViewPage::Message message;
  for (int i = 0; i < 5; ++i) page.see();
  for (const double tick : {1.0, 2.0}) {
    page.give_frame(frame_with(tick), 0);
    CHECK(tick_of_next(page) == tick);
  }
  page.give_frame(frame_with(3), 0);
  CHECK_FALSE(page.next(message));
}

}  // namespace view_page_test
