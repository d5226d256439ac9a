// SPDX-License-Identifier: Apache-2.0
// Applications that send more than a tick takes.
#include <array>
#include <catch2/catch.hpp>
#include <memory>

#include "servo/app/app_state.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace app_turns_test {

using namespace spm;
using namespace spm::servo;
using namespace spm::test;

TEST_CASE(
    "Of applications that all send without end each gets its turn, and none more than others") {
  const auto state = small_state();
  constexpr std::size_t clients = SPM_MAX_CLIENTS;
  std::array<std::unique_ptr<RawRing>, clients> rings;
  std::array<std::size_t, clients> taken{}, written{};
  for (std::size_t i = 0; i < clients; ++i) {
    const auto connection = static_cast<std::uint32_t>(10 + i);
    rings[i] = std::make_unique<RawRing>(connection);
    state->rings()[i].offer(rings[i]->attached());
  }
  std::size_t all = 0;
  for (int tick = 1; tick <= 400; ++tick) {
    for (std::size_t i = 0; i < clients; ++i) {
      for (; written[i] - rings[i]->ring().tail < SPM_RING_SLOTS; ++written[i]) {
        rings[i]->write(move_command(std::uint64_t{10 + i} << 32U | 1U, 0.1));
      }
    }
    for (const AppCommand& command : state->take(tick)) {
      ++taken[command.client];
      ++all;
    }
  }
  const std::size_t even = all / clients;
  REQUIRE(even > 100);
  for (std::size_t i = 0; i < clients; ++i) {
    CAPTURE(i, taken[i]);
    CHECK(taken[i] > even * 9 / 10);
    CHECK(taken[i] < even * 11 / 10);
  }
}

}  // namespace app_turns_test
