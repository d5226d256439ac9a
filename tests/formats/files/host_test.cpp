// SPDX-License-Identifier: Apache-2.0
#include "formats/files/host.hpp"

#include <catch2/catch.hpp>

namespace host_test {

using namespace spm;

TEST_CASE("A 64-bit little-endian machine may use files, such as the one this test runs on") {
  CHECK(check_host("a.spm.exr").has_value());
  CHECK(check_host("a.spm.exr", {.order = std::endian::little, .address_bits = 64}).has_value());
}

TEST_CASE("A big-endian or a 32-bit machine is refused with exit code 5 and a sentence") {
  const auto refused = [](const Host& host, const std::string& cause) {
    const auto checked = check_host("a.spm.exr", host);
    REQUIRE(!checked);
    CHECK(checked.error().code == ExitCode::unsupported);
    CHECK(static_cast<int>(checked.error().code) == 5);
    CHECK_THAT(checked.error().message, Catch::StartsWith("a.spm.exr: ") &&
                                            Catch::Contains(cause) &&
                                            Catch::Contains("use a 64-bit little-endian machine"));
    CHECK(checked.error().message.find('\n') == std::string::npos);
  };
  refused({.order = std::endian::big, .address_bits = 64}, "not little-endian");
  refused({.order = std::endian::big, .address_bits = 32}, "not little-endian");
  refused({.order = std::endian::little, .address_bits = 32}, "addresses of 32 bits");
}

}  // namespace host_test
