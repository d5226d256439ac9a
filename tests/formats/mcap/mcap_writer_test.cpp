// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap/mcap_writer.hpp"

#include <zlib.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "tests/formats/support/synthetic_asset.hpp"

namespace mcap_writer_test {

namespace {

using namespace spm;
using spm::test::TemporaryFolder;

constexpr std::size_t magic_bytes = 8, head_bytes = 9, crc_bytes = 4;

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number;
  REQUIRE(at + sizeof number <= bytes.size());
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

struct Record {
  int kind = 0;
  std::size_t at = 0, size = 0;  ///< of its content
};

/// The records of a file, one after the other; each byte between the magic numbers is of one.
std::vector<Record> records_of(const std::string& bytes) {
  std::vector<Record> list;
  std::size_t at = magic_bytes;
  while (at < bytes.size() - magic_bytes) {
    const auto size = number_at<std::uint64_t>(bytes, at + 1);
    list.push_back({static_cast<unsigned char>(bytes[at]), at + head_bytes, size});
    at += head_bytes + size;
  }
  REQUIRE(at == bytes.size() - magic_bytes);
  return list;
}

std::uint32_t crc_of(const std::string& bytes, std::size_t from, std::size_t to) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()) + from,
            static_cast<unsigned>(to - from)));
}

constexpr int messages = 40'000;

std::string payload(int i) { return "{\"number\":" + std::to_string(i) + "}"; }

/// Two channels, several chunks.
std::string write_some(const std::string& path) {
  auto writer = McapWriter::create(path, "", "test");
  REQUIRE(writer);
  const std::uint16_t schema = writer->add_schema("Number", "jsonschema", "{}");
  const std::uint16_t even = writer->add_channel(schema, "/even", "json");
  const std::uint16_t odd = writer->add_channel(schema, "/odd", "json");
  writer->add_metadata("about", {{"b", "2"}, {"a", "1"}});
  for (int i = 0; i < messages; ++i) {
    writer->write(i % 2 == 0 ? even : odd, static_cast<std::uint64_t>(i) * 1000, payload(i));
  }
  REQUIRE(writer->commit());
  return content(path);
}

std::vector<Record> of_kind(const std::vector<Record>& records, int kind) {
  std::vector<Record> list;
  for (const Record& record : records) {
    if (record.kind == kind) list.push_back(record);
  }
  return list;
}

}  // namespace

TEST_CASE("Equal messages give equal bytes") {
  const TemporaryFolder folder;
  CHECK(write_some(folder.path("a.mcap")) == write_some(folder.path("b.mcap")));
}

TEST_CASE("Each message is found by the index of its chunk") {
  const TemporaryFolder folder;
  const std::string bytes = write_some(folder.path("a.mcap"));
  const auto records = records_of(bytes);
  const auto chunks = of_kind(records, 0x06);
  REQUIRE(chunks.size() > 1);
  int found = 0;
  std::size_t chunk = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].kind == 0x06) chunk = records[i].at;
    if (records[i].kind != 0x07) continue;
    const auto channel = number_at<std::uint16_t>(bytes, records[i].at);
    const auto length = number_at<std::uint32_t>(bytes, records[i].at + 2);
    // Times, sizes, checksum and an empty name of the compression stand before a chunk's records.
    const std::size_t inside = chunk + 8 + 8 + 8 + 4 + 4 + 8;
    for (std::size_t at = records[i].at + 6; at < records[i].at + 6 + length; at += 16) {
      const auto time = number_at<std::uint64_t>(bytes, at);
      const std::size_t message = inside + number_at<std::uint64_t>(bytes, at + 8);
      const auto number = static_cast<int>(time / 1000);
      REQUIRE(bytes[message] == 0x05);
      REQUIRE(number_at<std::uint16_t>(bytes, message + head_bytes) == channel);
      REQUIRE(number_at<std::uint64_t>(bytes, message + head_bytes + 6) == time);
      REQUIRE(channel == (number % 2 == 0 ? 1 : 2));
      REQUIRE(bytes.substr(message + head_bytes + 22, payload(number).size()) == payload(number));
      ++found;
    }
  }
  CHECK(found == messages);
}

TEST_CASE("The checksums of chunks, data and summary are those of their bytes") {
  const TemporaryFolder folder;
  const std::string bytes = write_some(folder.path("a.mcap"));
  const auto records = records_of(bytes);
  for (const Record& chunk : of_kind(records, 0x06)) {
    const std::size_t inside = chunk.at + 8 + 8 + 8 + 4 + 4 + 8;
    CHECK(number_at<std::uint32_t>(bytes, chunk.at + 24) ==
          crc_of(bytes, inside, chunk.at + chunk.size));
  }
  const Record end = of_kind(records, 0x0F).front();
  CHECK(number_at<std::uint32_t>(bytes, end.at) == crc_of(bytes, 0, end.at - head_bytes));
  const Record footer = records.back();
  REQUIRE(footer.kind == 0x02);
  const auto summary = number_at<std::uint64_t>(bytes, footer.at);
  CHECK(summary == end.at + end.size);
  const std::size_t crc_at = footer.at + footer.size - crc_bytes;
  CHECK(number_at<std::uint32_t>(bytes, crc_at) == crc_of(bytes, summary, crc_at));
}

TEST_CASE("A file that is not committed, or stands in a folder that is missing, leaves nothing") {
  const TemporaryFolder folder;
  {
    auto writer = McapWriter::create(folder.path("a.mcap"), "", "test");
    REQUIRE(writer);
  }
  CHECK_FALSE(std::filesystem::exists(folder.path("a.mcap")));
  const auto nowhere = McapWriter::create(folder.path("none") + "/a.mcap", "", "test");
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == ExitCode::file_or_device);
}

}  // namespace mcap_writer_test
