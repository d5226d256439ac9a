// SPDX-License-Identifier: Apache-2.0
#include "formats/files/sha256.hpp"

#include <catch2/catch.hpp>

#include "tests/formats/support/synthetic_asset.hpp"

namespace sha256_test {

TEST_CASE("SHA-256 gives the digests of FIPS 180-4") {
  CHECK(spm::sha256_bytes(std::string_view("")) ==
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(spm::sha256_bytes(std::string_view("abc")) ==
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_CASE("The hash of a file is that of its bytes, and a missing file is refused") {
  const spm::test::TemporaryFolder folder;
  const std::string bytes(3'000'001, 'x');
  spm::test::write_bytes(folder.path("a"), bytes);
  CHECK(spm::sha256_file(folder.path("a")).value() == spm::sha256_bytes(bytes));
  const auto missing = spm::sha256_file(folder.path("b"));
  REQUIRE(!missing);
  CHECK(missing.error().code == spm::ExitCode::file_or_device);
}

}  // namespace sha256_test
