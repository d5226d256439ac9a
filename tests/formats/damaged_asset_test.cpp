// SPDX-License-Identifier: Apache-2.0
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputPart.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <functional>

#include "formats/exr_header.hpp"
#include "formats/exr_layout.hpp"
#include "formats/mapped_asset.hpp"
#include "tests/formats/exr_by_hand.hpp"
#include "tests/formats/synthetic_asset.hpp"

namespace {

using namespace spm;
using namespace spm::test;

constexpr int refused = 3;

std::string baked(const Asset& asset) {
  const TemporaryFolder folder;
  REQUIRE(write_asset(asset, folder.path("a")).has_value());
  return read_bytes(folder.path("a"));
}

std::string sparse_bytes() { return baked(sparse_asset(1)); }
std::string full_bytes() { return baked(full_asset(1, {2, 2, 1, 12, 2})); }

/// Replaces text in the header by text of the same length and makes the checksum right again.
std::string with_header_text(std::string bytes, const std::string& from, const std::string& to) {
  const std::size_t at = bytes.find(from);
  REQUIRE(at != std::string::npos);
  REQUIRE(from.size() == to.size());
  bytes.replace(at, from.size(), to);
  reseal(bytes);
  return bytes;
}

/// Puts a word at an offset and makes the checksum right again.
std::string with_word(std::string bytes, std::uint64_t offset, std::uint32_t word) {
  for (std::size_t k = 0; k < 4; ++k) bytes.at(offset + k) = static_cast<char>(word >> (8 * k));
  reseal(bytes);
  return bytes;
}

/// Offset of word k of a flat part, found by hand.
std::uint64_t flat_word(const std::string& bytes, const std::string& name, std::uint64_t k) {
  for (const HandPart& part : read_by_hand(bytes).parts) {
    if (part.name() == name) return part.table[0] + 24 + 4 * k;
  }
  FAIL("no part " << name);
  return 0;
}

/// First word of a record of the grid.
std::uint64_t record_cell(const Asset& asset) {
  std::uint64_t cell = 0;
  while (asset.grid.index[cell] >> 30U != 2) ++cell;
  return cell;
}

/// An EXR as another program would write it: scan lines, one part, with attributes if wanted.
std::string foreign_exr(bool attributes_of_ours) {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.exr");
  Imf::Header header(16, 16);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  if (attributes_of_ours) {
    header.insert("spm", Imf::StringAttribute("{}"));
    header.insert("spm_bytes", Imf::StringAttribute(std::string(20, '0')));
    header.insert("spm_checksum", Imf::StringAttribute(std::string(16, '0')));
  }
  {
    std::vector<float> pixels(256, 0.5F);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data()), 4, 64));
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(16);
  }
  std::string bytes = read_bytes(path);
  reseal(bytes);
  return bytes;
}

/// An asset of one channel a part as another tool saves it: the same parts, attributes and pixels,
/// with the header changed.
std::string resaved(const std::string& bytes, const std::function<void(Imf::Header&)>& change) {
  const TemporaryFolder folder;
  write_bytes(folder.path("in"), bytes);
  {
    Imf::MultiPartInputFile in(folder.path("in").c_str());
    std::vector<Imf::Header> headers;
    for (int part = 0; part < in.parts(); ++part) {
      headers.push_back(in.header(part));
      change(headers.back());
    }
    Imf::MultiPartOutputFile out(folder.path("out").c_str(), headers.data(), in.parts());
    for (int part = 0; part < in.parts(); ++part) {
      Imf::TiledInputPart from(in, part);
      Imf::TiledOutputPart to(out, part);
      const Imf::Header& header = in.header(part);
      const int width = header.dataWindow().max.x + 1, height = header.dataWindow().max.y + 1;
      std::vector<std::uint32_t> pixels(static_cast<std::size_t>(width * height));
      Imf::FrameBuffer buffer;
      buffer.insert("Y", Imf::Slice(header.channels().begin().channel().type,
                                    reinterpret_cast<char*>(pixels.data()), 4,
                                    4 * static_cast<std::size_t>(width)));
      from.setFrameBuffer(buffer);
      from.readTiles(0, from.numXTiles() - 1, 0, from.numYTiles() - 1);
      to.setFrameBuffer(buffer);
      to.writeTiles(0, to.numXTiles() - 1, 0, to.numYTiles() - 1);
    }
  }
  std::string saved = read_bytes(folder.path("out"));
  reseal(saved);
  return saved;
}

struct Damage {
  std::string name;
  std::string bytes;
  std::string cause;  ///< words of the message
};

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

std::vector<Damage> foreign_files() {
  return {
      {"empty", "", "is empty"},
      {"one byte", "x", "no EXR file"},
      {"text", "solid cube\nendsolid\n", "no EXR file"},
      {"garbage", std::string(5000, '\xa5'), "no EXR file"},
      {"only the magic number", std::string("\x76\x2f\x31\x01", 4), "cut short"},
      {"magic number and zeros", std::string("\x76\x2f\x31\x01", 4) + std::string(500, '\0'),
       "no `spm` attribute"},
      {"scan-line EXR of another program", foreign_exr(false), "no `spm` attribute"},
      {"scan-line EXR with our attributes", foreign_exr(true), "not a multi-part EXR"},
  };
}

std::vector<Damage> structural_damage() {
  const std::string sparse = sparse_bytes();
  const std::string full = full_bytes();
  const std::uint64_t table = read_by_hand(sparse).header_bytes;
  const auto part_renamed = with_header_text(full, "heights12", "heights11");
  std::string appended = sparse + "more";
  std::string appended_resealed = appended;
  reseal(appended_resealed);
  return {
      {"compressed",
       resaved(sparse, [](Imf::Header& h) { h.compression() = Imf::ZIP_COMPRESSION; }),
       "is compressed"},
      {"another line order",
       resaved(sparse, [](Imf::Header& h) { h.lineOrder() = Imf::DECREASING_Y; }),
       "increasing line order"},
      {"bytes appended", appended, "size differs"},
      {"bytes appended, size and checksum right", appended_resealed, "end with its last tile"},
      {"a tile's offset points elsewhere", with_word(sparse, table, word_at(sparse, table) + 4),
       "damaged"},
      {"two tiles at one place", with_word(sparse, table + 8, word_at(sparse, table)), "damaged"},
      {"an offset past the end", with_word(sparse, table + 4, 1), "damaged"},
      {"a tile's size", with_word(sparse, word_at(sparse, table) + 20, 64), "damaged"},
      {"a tile's part", with_word(sparse, word_at(sparse, table), 3), "damaged"},
      {"a part renamed", part_renamed, "heights11"},
      {"a part of an unknown name", with_header_text(sparse, "grid_masks", "grid_musks"),
       "grid_musks"},
      {"a channel renamed", with_header_text(full, "hit10.Y", "hit10.Z"), "heights12"},
  };
}

std::vector<Damage> wrong_descriptions() {
  const std::string sparse = sparse_bytes();
  const std::string full = full_bytes();
  return {
      {"another version", with_header_text(sparse, "\"format_version\":1", "\"format_version\":7"),
       "format version 7, this program reads 1"},
      {"tolerance NaN",
       with_header_text(sparse, "\"tolerance\":3.3333333333333335e-05",
                        "\"tolerance\":NaN                   "),
       "not a JSON object"},
      {"tolerance negative", with_header_text(sparse, "\"tolerance\":3.3", "\"tolerance\":-33"),
       "`tolerance`"},
      {"units of millimetres", with_header_text(sparse, "\"units\":\"m\"", "\"units\":\"k\""),
       "`units`"},
      {"a map too many", with_header_text(sparse, "\"count\":100", "\"count\":101"), "grid_ma"},
      {"other columns", with_header_text(sparse, "\"columns\":8", "\"columns\":9"), "part "},
      {"a triangle too many",
       with_header_text(sparse, "\"triangles\":20,\"planes\"", "\"triangles\":21,\"planes\""),
       "triangles"},
      {"a grid of other size", with_header_text(sparse, "\"cells\":[7,7,5]", "\"cells\":[7,7,9]"),
       "grid_index"},
      {"a tile of two planes", with_header_text(full, "\"tile\":1}", "\"tile\":2}"), "two planes"},
      {"a tile that does not exist", with_header_text(full, "\"tile\":1}", "\"tile\":9}"),
       "does not exist"},
      {"the form of another layout",
       with_header_text(full, "\"form\":\"full\"", "\"form\":\"fill\""), "`form`"},
      {"the attribute renamed",
       with_header_text(sparse, std::string("spm\0string", 10), std::string("spn\0string", 10)),
       "no `spm` attribute"},
      {"no checksum", with_header_text(sparse, "spm_checksum", "spm_chocksum"), "no checksum"},
  };
}

std::vector<Damage> wrong_content() {
  const Asset asset = sparse_asset(1);
  const std::string sparse = sparse_bytes();
  const std::string full = full_bytes();
  const std::uint64_t cell = record_cell(asset);
  const std::uint32_t record = asset.grid.index[cell] & 0x3FFFFFFFU;
  const auto index = flat_word(sparse, "grid_index", cell);
  const auto first = flat_word(sparse, "grid_records", record);
  constexpr std::uint32_t nan = 0x7FC00000, infinity = 0x7F800000;
  return {
      {"a record outside", with_word(sparse, index, (2U << 30U) | 0x3FFFFFFFU), "grid cell"},
      {"a record cut short", with_word(sparse, first, 0xFFFF), "cut short"},
      {"a record with a map that is not", with_word(sparse, first + 4, 100), "does not exist"},
      {"a record with a layer that is not", with_word(sparse, first + 4, 1U << 24U),
       "does not exist"},
      {"a record with a triangle that is not",
       with_word(with_word(sparse, first, 1U << 16U), first + 4, 20), "does not exist"},
      {"a map of no plane", with_word(sparse, flat_word(sparse, "grid_map_planes", 4), 10),
       "map 2"},
      {"a map of NaN spacing", with_word(sparse, flat_word(sparse, "grid_maps", 5), nan), "map 1"},
      {"a map of zero spacing", with_word(sparse, flat_word(sparse, "grid_maps", 5), 0), "map 1"},
      {"a NaN sample", with_word(sparse, flat_word(sparse, "heights", 70), nan), "map 1 "},
      {"an infinite sample in a sparse asset",
       with_word(sparse, flat_word(sparse, "heights", 70), infinity), "map 1 "},
      {"a NaN sample in a full asset", with_word(full, flat_word(full, "heights02", 3), nan),
       "not numbers"},
      {"a triangle at infinity", with_word(sparse, flat_word(sparse, "triangles", 8), infinity),
       "triangles"},
  };
}

void check_all_refused(const std::vector<Damage>& cases) {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  for (const Damage& damage : cases) {
    write_bytes(path, damage.bytes);
    check_refused(damage, path);
  }
}

}  // namespace

TEST_CASE("A file that never was an asset is told what it is not") {
  check_all_refused(foreign_files());
}

TEST_CASE("An asset whose layout was changed is refused, its checksum made right or not") {
  check_all_refused(structural_damage());
}

TEST_CASE("An asset whose description was changed is refused") {
  check_all_refused(wrong_descriptions());
}

TEST_CASE("An asset whose grid, maps or triangles were changed is refused") {
  check_all_refused(wrong_content());
}

TEST_CASE("An asset cut short anywhere is refused as cut short") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  const std::string bytes = sparse_bytes();
  Random random(4);
  std::vector<std::size_t> lengths{5, 8, 9, 100, 1000, 4096, bytes.size() / 2, bytes.size() - 1};
  for (int k = 0; k < 40; ++k)
    lengths.push_back(5 + random.below(static_cast<std::uint32_t>(bytes.size() - 5)));
  for (const std::size_t length : lengths) {
    write_bytes(path, bytes.substr(0, length));
    check_refused({std::to_string(length), {}, "cut short"}, path);
  }
}

TEST_CASE("Any flipped bit of an asset is found by its checksum") {
  const TemporaryFolder folder(TemporaryFolder::Place::memory);
  const std::string path = folder.path("a.spm.exr");
  for (const std::string& bytes : {sparse_bytes(), full_bytes()}) {
    const auto header = static_cast<std::uint32_t>(read_by_hand(bytes).header_bytes);
    Random random(5);
    for (int k = 0; k < 400; ++k) {
      // Half of the flips in the header, which is the smaller part.
      const std::uint32_t at =
          random.below(k % 2 == 0 ? header : static_cast<std::uint32_t>(bytes.size()));
      std::string flipped = bytes;
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << random.below(8)));
      write_bytes(path, flipped);
      const auto opened = MappedAsset::open(path);
      INFO("byte " << at);
      REQUIRE(!opened);
      REQUIRE(opened.error().code == ExitCode::invalid_input);
    }
  }
}

TEST_CASE("What is not a readable file is a file error") {
  const TemporaryFolder folder;
  const std::string pipe = folder.path("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0666) == 0);
  for (const std::string& path :
       {folder.path("missing.spm.exr"), folder.folder(), pipe, std::string("/dev/null"),
        folder.path("missing/a.spm.exr"), std::string()}) {
    INFO(path);
    const auto opened = MappedAsset::open(path);
    REQUIRE(!opened);
    CHECK(opened.error().code == ExitCode::file_or_device);
    CHECK(opened.error().message.find(path + ": ") == 0);
    CHECK(opened.error().message.find("; ") != std::string::npos);
  }
}

TEST_CASE("An asset without permission to read is a file error") {
  if (::geteuid() == 0) {
    WARN("skipped: root may read everything");
    return;
  }
  const TemporaryFolder folder;
  write_bytes(folder.path("a.spm.exr"), sparse_bytes());
  REQUIRE(::chmod(folder.path("a.spm.exr").c_str(), 0) == 0);
  const auto opened = MappedAsset::open(folder.path("a.spm.exr"));
  REQUIRE(!opened);
  CHECK(opened.error().code == ExitCode::file_or_device);
}
