// SPDX-License-Identifier: Apache-2.0
// Whatever an application sends, and however often: the hand gets no energy of it but what a change
// of the potential is, and no knock.
#include "tests/servo/support/command_streams.hpp"

#include <catch2/catch.hpp>

#include "common/base/smooth_change.hpp"

namespace command_streams_test {

using namespace spm;
using namespace spm::test;

namespace {

/// A push is work by intent, and a clutch leaves the tool elsewhere.
bool is_of_the_potential(StreamKind kind) {
  return kind != StreamKind::push && kind != StreamKind::clutch;
}

void check(const CommandStream& stream) {
  CAPTURE(name_of(stream.kind), stream.rate_hz, stream.seed, stream.stabilized);
  const StreamOutcome outcome = run_stream(stream);
  CHECK(outcome.largest_force > 0.4);
  CHECK(outcome.energy <= outcome.allowed + 1e-4);
}

}  // namespace

TEST_CASE("No stream of commands gives a hand more energy than the changes of the potential") {
  for (std::uint64_t number = 0; number < std::uint64_t{10} * stream_kinds; ++number) {
    const CommandStream stream = stream_of(number);
    if (is_of_the_potential(stream.kind)) check(stream);
  }
}

TEST_CASE("No stream of commands gives a hand more energy than the changes, ten thousand streams",
          "[.long]") {
  for (std::uint64_t number = 0; number < 10'000; ++number) {
    const CommandStream stream = stream_of(number);
    if (is_of_the_potential(stream.kind)) check(stream);
  }
}

TEST_CASE("A stream that changes nothing changes no force, at any rate") {
  for (const double rate : {15., 60., 250., 1000.}) {
    for (const StreamKind kind :
         {StreamKind::same_far, StreamKind::same_touched, StreamKind::added_far}) {
      for (const bool stabilized : {true, false}) {
        const CommandStream stream{kind, rate, 3, stabilized};
        CommandStream silent = stream;
        silent.rate_hz = 0;
        CAPTURE(name_of(kind), rate, stabilized);
        const StreamOutcome with = run_stream(stream), without = run_stream(silent);
        CHECK(with.energy == without.energy);
        CHECK(with.largest_step == without.largest_step);
      }
    }
  }
}

TEST_CASE("No command makes a step of the force on a hand that keeps still") {
  for (std::uint8_t kind = 0; kind < stream_kinds; ++kind) {
    for (const double rate : {15., 60., 1000.}) {
      const bool stabilized = (kind + static_cast<int>(rate)) % 2 == 0;
      const CommandStream stream{static_cast<StreamKind>(kind), rate, kind, stabilized, true, 2};
      CAPTURE(name_of(stream.kind), rate, stabilized);
      const StreamOutcome outcome = run_stream(stream);
      CHECK(outcome.largest_force > 0.4);
      CHECK(outcome.largest_step <= change_rate * 1e-3 + 1e-6);
    }
  }
}

}  // namespace command_streams_test
