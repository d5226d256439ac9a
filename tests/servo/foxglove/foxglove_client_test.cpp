// SPDX-License-Identifier: Apache-2.0
#include "servo/foxglove/foxglove_client.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace foxglove_client_test {

using namespace spm;
using namespace spm::servo;
using nlohmann::json;

namespace {

HandSample sample() {
  HandSample sample;
  sample.tick = 1500;
  sample.time_ns = 1'500'000'007;
  sample.hand.position = {0.1, 0.2, 0.3};
  sample.held = {0.1, 0.2, 0.31};
  sample.sent.force = {0, 0, 2};
  sample.depth = 0.01;
  sample.contact = true;
  return sample;
}

const FoxgloveChannel& of_topic(const std::vector<FoxgloveChannel>& channels,
                                const std::string& topic) {
  for (const FoxgloveChannel& channel : channels) {
    if (channel.topic == topic) return channel;
  }
  FAIL("no channel " + topic);
  return channels.front();
}

}  // namespace

TEST_CASE("A client is answered in the first protocol that both speak") {
  CHECK(chosen_protocol("foxglove.websocket.v1") == "foxglove.websocket.v1");
  CHECK(chosen_protocol("other, foxglove.websocket.v1 ,foxglove.sdk.v1") == "foxglove.sdk.v1");
  CHECK(chosen_protocol("foxglove.websocket.v2").empty());
  CHECK(chosen_protocol("").empty());
}

TEST_CASE("Channels are offered once, and again where a tool comes") {
  FoxgloveClient client;
  const auto first = client.offer(channels_of({false}));
  REQUIRE(first.size() == 1);
  const json offer = json::parse(first[0]);
  CHECK(offer["op"] == "advertise");
  CHECK(offer["channels"].size() == 5);
  for (const json& channel : offer["channels"]) {
    CHECK(channel["encoding"] == "json");
    CHECK(channel["schemaEncoding"] == "jsonschema");
    CHECK(json::parse(channel["schema"].get<std::string>())["title"] == channel["schemaName"]);
  }
  CHECK(client.offer(channels_of({false})).empty());
  REQUIRE(client.hear(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1}]})").empty());
  const auto again = client.offer(channels_of({true}));
  REQUIRE(again.size() == 2);
  CHECK(json::parse(again[0])["channelIds"].size() == 5);
  CHECK(json::parse(again[1])["channels"].size() == 6);
  CHECK(client.subscriptions().empty());
}

TEST_CASE("A client subscribes and ends it, and what it may not is answered and changes nothing") {
  FoxgloveClient client;
  static_cast<void>(client.offer(channels_of({false})));
  CHECK(client.hear(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]})").empty());
  CHECK(client.subscriptions() == std::map<std::uint32_t, std::uint32_t>{{7, 2}});
  for (const char* wrong :
       {"no json", "[]", R"({"op":5})", R"({"op":"setParameters"})",
        R"({"op":"subscribe","subscriptions":[{"id":8,"channelId":99}]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":["x"]})"}) {
    INFO(wrong);
    const json answer = json::parse(client.hear(wrong));
    CHECK(answer["op"] == "status");
    CHECK(answer["level"].get<int>() >= 1);
    CHECK(client.subscriptions().size() == 1);
  }
  CHECK(client.hear(R"({"op":"unsubscribe","subscriptionIds":[7,8]})").empty());
  CHECK(client.subscriptions().empty());
}

TEST_CASE("A message has opcode, subscription and time before its payload, little endian") {
  const std::string bytes = FoxgloveClient::message(0x01020304, 0x1112131415161718U, "{}");
  CHECK(bytes == std::string("\x01\x04\x03\x02\x01\x18\x17\x16\x15\x14\x13\x12\x11{}", 15));
}

TEST_CASE("Messages tell hand, force and depth of a tick") {
  const auto channels = channels_of({false});
  const json pose = json::parse(message_of(of_topic(channels, "/hand/0/pose"), sample()));
  CHECK(pose["timestamp"] == json({{"sec", 1}, {"nsec", 500'000'007}}));
  CHECK(pose["pose"]["position"]["z"] == 0.3);
  CHECK(json::parse(message_of(of_topic(channels, "/hand/0/held"),
                               sample()))["pose"]["position"]["z"] == 0.31);
  const json tick = json::parse(message_of(of_topic(channels, "/hand/0/tick"), sample()));
  CHECK(tick["force_size"] == 2);
  CHECK(tick["depth"] == 0.01);
  CHECK_FALSE(tick.contains("wake_us"));
  const json scene = json::parse(message_of(of_topic(channels, "/hand/0/force"), sample()));
  const json arrow = scene["entities"][0]["arrows"][0];
  CHECK(arrow["shaft_length"].get<double>() + arrow["head_length"].get<double>() == Approx(0.02));
  // The arrow points along x before it is turned.
  const json turn = arrow["pose"]["orientation"];
  CHECK(turn["y"].get<double>() == Approx(-std::sqrt(0.5)));
}

TEST_CASE("The log speaks when the force goes off or comes back, and is silent else") {
  HandSample off = sample();
  off.cause = "stalled";
  off.cure = "give it priority";
  CHECK(log_message(sample(), "none").empty());
  const json gone = json::parse(log_message(off, "none"));
  CHECK(gone["message"] == "no force: stalled; give it priority");
  CHECK(gone["level"] == 3);
  CHECK(log_message(off, "stalled").empty());
  CHECK(json::parse(log_message(sample(), "stalled"))["level"] == 2);
}

}  // namespace foxglove_client_test
