// SPDX-License-Identifier: Apache-2.0
#include "formats/cli/byte_size.hpp"

#include <catch2/catch.hpp>

namespace byte_size_test {

using spm::cli::parse_byte_size;

TEST_CASE("A number of bytes is read with its unit") {
  CHECK(*parse_byte_size("0B") == 0);
  CHECK(*parse_byte_size("12kB") == 12'000);
  CHECK(*parse_byte_size("1.5GB") == 1'500'000'000);
  CHECK(*parse_byte_size("2MiB") == 2'097'152);
}

TEST_CASE("A number of bytes without a unit, or anything else, is refused") {
  for (const char* text : {"", "12", "GB", "-1GB", "1gb", "1 GB", "1e40TB", "nanMB", "1GBx"}) {
    INFO(text);
    CHECK_FALSE(parse_byte_size(text));
  }
}

}  // namespace byte_size_test
