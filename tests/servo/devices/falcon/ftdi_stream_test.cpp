// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/ftdi_stream.hpp"

#include <catch2/catch.hpp>
#include <vector>

namespace ftdi_stream_test {

using spm::servo::strip_ftdi_status;

namespace {

/// What an FTDI chip sends for data: packets of at most 64 bytes, two of status in front of each.
std::vector<std::uint8_t> with_status(const std::vector<std::uint8_t>& data) {
  std::vector<std::uint8_t> transfer;
  for (std::size_t begin = 0; begin < data.size() || begin == 0; begin += 62) {
    transfer.push_back(0x01);
    transfer.push_back(0x60);
    for (std::size_t i = begin; i < std::min(begin + 62, data.size()); ++i) {
      transfer.push_back(data[i]);
    }
  }
  return transfer;
}

std::vector<std::uint8_t> stripped(std::vector<std::uint8_t> transfer) {
  transfer.resize(strip_ftdi_status(transfer));
  return transfer;
}

}  // namespace

TEST_CASE("Every packet of a transfer loses its two bytes of status, and only those") {
  for (std::size_t size = 0; size <= 200; ++size) {
    CAPTURE(size);
    std::vector<std::uint8_t> data(size);
    for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i + 1);
    REQUIRE(stripped(with_status(data)) == data);
  }
}

TEST_CASE("A packet of status alone, or of less, holds no data") {
  REQUIRE(stripped({}).empty());
  REQUIRE(stripped({0x01}).empty());
  REQUIRE(stripped({0x01, 0x60}).empty());
}

TEST_CASE("A last packet that was cut within its status gives nothing") {
  std::vector<std::uint8_t> transfer = with_status(std::vector<std::uint8_t>(62, 'A'));
  transfer.push_back(0x01);
  REQUIRE(stripped(transfer) == std::vector<std::uint8_t>(62, 'A'));
}

}  // namespace ftdi_stream_test
