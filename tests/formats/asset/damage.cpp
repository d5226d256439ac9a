// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/asset/damage.hpp"

#include <catch2/catch.hpp>

#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/formats/support/exr_by_hand.hpp"
#include "tests/formats/support/synthetic_asset.hpp"

namespace spm::test {

namespace {

constexpr int refused = 3;

}  // namespace

std::string baked(const Asset& asset) {
  const TemporaryFolder folder;
  const auto written = write_asset(asset, folder.path("a"));
  INFO((written ? std::string() : written.error().message));
  REQUIRE(written.has_value());
  return read_bytes(folder.path("a"));
}

std::string with_header_text(std::string bytes, const std::string& from, const std::string& to) {
  const std::size_t at = bytes.find(from);
  INFO(from);
  REQUIRE(at != std::string::npos);
  REQUIRE(from.size() == to.size());
  bytes.replace(at, from.size(), to);
  reseal(bytes);
  return bytes;
}

std::string with_word(std::string bytes, std::uint64_t offset, std::uint32_t word) {
  for (std::size_t k = 0; k < 4; ++k) bytes.at(offset + k) = static_cast<char>(word >> (8 * k));
  reseal(bytes);
  return bytes;
}

std::uint64_t flat_word(const std::string& bytes, const std::string& name, std::uint64_t k) {
  for (const HandPart& part : read_by_hand(bytes).parts) {
    if (part.name() == name) return part.table[0] + 24 + 4 * k;
  }
  FAIL("no part " << name);
  return 0;
}

void check_refused(const Damage& damage, const std::string& path) {
  INFO(damage.name);
  for (const MapMode mode : {MapMode::file, MapMode::sealed}) {
    const auto opened = MappedAsset::open(path, {.mode = mode});
    REQUIRE(!opened);
    INFO(opened.error().message);
    CHECK(static_cast<int>(opened.error().code) == refused);
    CHECK(opened.error().message.find(path + ": ") == 0);
    CHECK(opened.error().message.find(damage.cause) != std::string::npos);
    CHECK(opened.error().message.find("; ") != std::string::npos);
    CHECK(opened.error().message.find("bake") != std::string::npos);
    CHECK(opened.error().message.find('\n') == std::string::npos);
  }
}

void check_all_refused(const std::vector<Damage>& cases) {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  for (const Damage& damage : cases) {
    write_bytes(path, damage.bytes);
    check_refused(damage, path);
  }
}

}  // namespace spm::test
