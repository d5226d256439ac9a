// SPDX-License-Identifier: Apache-2.0

// What hands got of streams of commands, by kind (servo/safety/FAULTS.md). Prints a JSON object,
// whose keys end in their units. The one argument is the number of streams.
//
// It compiles in the tree of commit 6f53be3, the last before these faults were mended, where Loop
// is given the same `step`.

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/servo/support/command_streams.hpp"

namespace {

using namespace spm::test;
using Json = nlohmann::ordered_json;

struct Worst {
  std::size_t streams = 0;
  double energy = -1, beyond = -1, step = 0;
};

Json of_kinds(const std::array<Worst, stream_kinds>& moving,
              const std::array<Worst, stream_kinds>& still) {
  Json kinds = Json::array();
  for (std::uint8_t kind = 0; kind < stream_kinds; ++kind) {
    kinds.push_back({{"kind", name_of(static_cast<StreamKind>(kind))},
                     {"streams", moving[kind].streams},
                     {"energy_max_j", moving[kind].energy},
                     {"beyond_allowed_max_j", moving[kind].beyond},
                     {"still_streams", still[kind].streams},
                     {"still_step_max_n", still[kind].step}});
  }
  return kinds;
}

}  // namespace

int main(int count, char** arguments) {
  const std::size_t streams = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1400;
  std::array<Worst, stream_kinds> moving{}, still{};
  for (std::size_t number = 0; number < streams; ++number) {
    CommandStream stream = stream_of(number);
    const StreamOutcome outcome = run_stream(stream);
    Worst& worst = moving[static_cast<std::size_t>(stream.kind)];
    ++worst.streams;
    worst.energy = std::max(worst.energy, outcome.energy);
    worst.beyond = std::max(worst.beyond, outcome.energy - outcome.allowed);
    // A hand that keeps still feels the commands alone.
    if (number >= streams / 10) continue;
    stream.still = true;
    Worst& kept = still[static_cast<std::size_t>(stream.kind)];
    ++kept.streams;
    kept.step = std::max(kept.step, run_stream(stream).largest_step);
  }
  const Json printed{{"streams", streams}, {"kinds", of_kinds(moving, still)}};
  std::puts(printed.dump(1).c_str());
  return 0;
}
