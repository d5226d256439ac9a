// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_wishes.hpp"

#include <catch2/catch.hpp>

namespace view_wishes_test {

using namespace spm::servo;

TEST_CASE("A page's wishes are read") {
  const auto led = read_wish(R"({"t":"hand","device":1,"p":[0.1,0,-2],"q":[1,0,0,0],"n":7})");
  REQUIRE(led);
  const auto& lead = std::get<LeadWish>(*led);
  CHECK(lead.device == 1);
  CHECK(lead.hand.position == spm::Vector3(0.1, 0, -2));
  CHECK(lead.number == 7);
  const auto felt = read_wish(R"({"t":"feel","object":4294967296,"stiffness":800})");
  REQUIRE(felt);
  const auto& feel = std::get<FeelWish>(*felt);
  CHECK(feel.object == 4294967296);
  CHECK(feel.feel.stiffness == 800);
  CHECK_FALSE(feel.feel.friction);
  CHECK(std::holds_alternative<FreeWish>(*read_wish(R"({"t":"free","device":0})")));
  CHECK(std::get<CapWish>(*read_wish(R"({"t":"cap","device":0,"newtons":3})")).newtons == 3);
  const auto chosen = std::get<MethodWish>(*read_wish(R"({"t":"method","object":2,"method":1})"));
  CHECK(chosen.object == 2);
  CHECK(chosen.method == SPM_CLIENT_METHOD_PAPER);
  CHECK(std::get<StabilizeWish>(*read_wish(R"({"t":"stabilize","on":1})")).on);
  CHECK(std::holds_alternative<SeenWish>(*read_wish(R"({"t":"seen"})")));
  CHECK(std::holds_alternative<AcknowledgeWish>(*read_wish(R"({"t":"acknowledge","device":0})")));
}

TEST_CASE("What is no wish, or has a number that is none, is refused as a whole") {
  const std::string text = GENERATE(
      R"()", R"([])", R"(null)", R"({"t":5})", R"({"t":"reboot"})", R"({"t":"free"})",
      R"({"t":"hand")", R"({"t":"free","device":-1})", R"({"t":"free","device":0.5})",
      R"({"t":"free","device":"0"})", R"({"t":"hand","device":0,"p":[0,0],"q":[1,0,0,0],"n":1})",
      R"({"t":"hand","device":0,"p":[0,0,null],"q":[1,0,0,0],"n":1})",
      R"({"t":"hand","device":0,"p":[0,0,1e999],"q":[1,0,0,0],"n":1})",
      R"({"t":"hand","device":0,"p":[0,0,0],"q":[1,1,0,0],"n":1})",
      R"({"t":"hand","device":0,"p":[0,0,0],"q":[1,0,0,0]})",
      R"({"t":"method","object":0,"method":3})", R"({"t":"stabilize","on":2})",
      R"({"t":"feel","object":0,"friction":[1]})", R"({"t":"feel","object":1e300,"damping":1})",
      R"({"t":"feel","object":0,"stiffness":"800"})", R"({"t":"cap","device":0,"newtons":null})");
  CAPTURE(text);
  CHECK_FALSE(read_wish(text));
}

}  // namespace view_wishes_test
