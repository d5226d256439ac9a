// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_foxglove.hpp"

#include <catch2/catch.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace view_foxglove_test {

using namespace spm::servo;
using nlohmann::json;

namespace {

/// A daemon of one device at a tick.
ViewState at_tick(std::uint64_t tick, std::uint32_t cause = 0) {
  ViewState state;
  state.tick.tick = tick;
  state.tick.time_ns = static_cast<std::int64_t>(tick) * 1'000'000;
  state.causes = {{"none", ""}, {"stalled", "give it priority"}};
  state.devices.resize(1);
  spm_client_device& device = state.devices[0].state;
  device.orientation[0] = 1;
  device.depth = 1e-3 * double(tick);
  device.cause = cause;
  return state;
}

ViewPage::Message next(FoxgloveViewer& viewer) {
  ViewPage::Message message;
  REQUIRE(viewer.next(message));
  return message;
}

json payload(const ViewPage::Message& message) {
  REQUIRE(message.is_frame);
  REQUIRE(message.bytes.size() > 13);
  return json::parse(message.bytes.substr(13));
}

}  // namespace

TEST_CASE("A viewer that is slow gets the newest message of a channel, and all of the log's") {
  FoxgloveDesk desk;
  const auto viewer = std::make_shared<FoxgloveViewer>([] {});
  desk.join(viewer);
  desk.look(at_tick(1));
  CHECK(json::parse(next(*viewer).bytes)["op"] == "serverInfo");
  const json offered = json::parse(next(*viewer).bytes);
  REQUIRE(offered["op"] == "advertise");
  json wish = {{"op", "subscribe"}, {"subscriptions", json::array()}};
  for (const json& channel : offered["channels"]) {
    if (channel["topic"] == "/hand/0/tick" || channel["topic"] == "/hand/0/log") {
      wish["subscriptions"].push_back({{"id", channel["id"]}, {"channelId", channel["id"]}});
    }
  }
  viewer->hear(wish.dump());
  desk.look(at_tick(2));
  desk.look(at_tick(3, 1));
  desk.look(at_tick(4));
  CHECK(payload(next(*viewer))["message"] == "no force: stalled; give it priority");
  CHECK(payload(next(*viewer))["message"] == "the force is on again");
  CHECK(payload(next(*viewer))["tick"] == 4);
  ViewPage::Message message;
  CHECK_FALSE(viewer->next(message));
  desk.look(at_tick(4));  // the same tick again
  CHECK_FALSE(viewer->next(message));
}

}  // namespace view_foxglove_test
