// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/wakeup_latency.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/servo/support/shape_asset.hpp"

namespace wakeup_latency_test {

using namespace spm::servo;
using spm::test::TemporaryFolder;

namespace {

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// How many descriptors of this process are open on a file.
std::size_t opened(const std::string& path) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code ignored;
    if (std::filesystem::read_symlink(entry.path(), ignored) == path) ++count;
  }
  return count;
}

}  // namespace

TEST_CASE(
    "No latency is asked of the cores while it is held, and the file stays open till the end") {
  const TemporaryFolder folder;
  const std::string path = std::filesystem::canonical(folder.path()).string() + "/latency";
  std::ofstream(path).close();
  {
    const WakeupLatency latency = WakeupLatency::hold(RealtimeMode::attempt, path);
    REQUIRE(latency.held());
    REQUIRE(latency.why().empty());
    REQUIRE(bytes_of(path) == std::string(4, '\0'));
    REQUIRE(opened(path) == 1);
  }
  REQUIRE(opened(path) == 0);
}

TEST_CASE("A latency that cannot be held says why, and where real time is off none is asked for") {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/none";
  const WakeupLatency missing = WakeupLatency::hold(RealtimeMode::attempt, path);
  REQUIRE_FALSE(missing.held());
  REQUIRE(missing.why().find(path) != std::string::npos);
  std::ofstream(path).close();
  const WakeupLatency off = WakeupLatency::hold(RealtimeMode::off, path);
  REQUIRE_FALSE(off.held());
  REQUIRE(off.why() == "real time was not asked for");
  REQUIRE(bytes_of(path).empty());
  // A device that takes nothing.
  REQUIRE_FALSE(WakeupLatency::hold(RealtimeMode::attempt, "/dev/full").held());
}

}  // namespace wakeup_latency_test
