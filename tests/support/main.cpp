// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <iostream>

#include "tests/support/skip.hpp"

namespace spm::test {
namespace {

bool skipped = false;

}  // namespace

void note_skip(const std::string& why) {
  skipped = true;
  std::cout << "SKIPPED: " << why << std::endl;
}

}  // namespace spm::test

int main(int argc, char** argv) {
  const int code = Catch::Session().run(argc, argv);
  return code == 0 && spm::test::skipped ? spm::test::skip_code : code;
}
