// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/core_pinning.hpp"

#include <catch2/catch.hpp>
#include <thread>

namespace core_pinning_test {

using namespace spm::servo;

namespace {

cpu_set_t allowed() {
  cpu_set_t cores;
  REQUIRE(sched_getaffinity(0, sizeof cores, &cores) == 0);
  return cores;
}

unsigned last_of(const cpu_set_t& cores) {
  unsigned last = 0;
  for (unsigned core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(core, &cores)) last = core;
  }
  return last;
}

}  // namespace

TEST_CASE("A core holds a thread and those it starts, until it is let go") {
  const cpu_set_t before = allowed();
  const unsigned core = last_of(before);
  {
    const auto pinned = CorePinning::hold(core);
    REQUIRE(pinned);
    cpu_set_t of_thread;
    std::thread([&] { of_thread = allowed(); }).join();
    REQUIRE(CPU_COUNT(&of_thread) == 1);
    REQUIRE(CPU_ISSET(core, &of_thread));
  }
  const cpu_set_t after = allowed();
  REQUIRE(CPU_EQUAL(&before, &after));
}

TEST_CASE("A core that there is not is refused with those that there are") {
  for (const unsigned core : {CPU_SETSIZE - 1U, 4'000'000'000U}) {
    const auto pinned = CorePinning::hold(core);
    REQUIRE_FALSE(pinned);
    REQUIRE(pinned.error().code == spm::ExitCode::usage);
    REQUIRE(pinned.error().message.find("it may use 0") != std::string::npos);
  }
  REQUIRE(CorePinning::hold({}));
}

}  // namespace core_pinning_test
