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

#include "formats/asset/chart_words.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/exr/exr_header.hpp"
#include "formats/exr/exr_layout.hpp"
#include "tests/formats/asset/damage.hpp"
#include "tests/formats/support/exr_by_hand.hpp"
#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/as_nobody.hpp"
#include "tests/support/skip.hpp"

namespace damaged_asset_test {

namespace {

using namespace spm;
using namespace spm::test;

std::string sparse_bytes() { return baked(sparse_asset(1)); }
std::string full_bytes() { return baked(full_asset(1, {2, 2, 1, 12, 2})); }

/// Changes the first digit of a number in the description: the one with this key after `object`.
std::string with_other_number(std::string bytes, const std::string& object, std::string key) {
  key = '"' + key + "\":";
  const std::size_t at = bytes.find(key, bytes.find('"' + object + '"'));
  REQUIRE(at != std::string::npos);
  char& digit = bytes.at(at + key.size());
  digit = digit == '9' ? '8' : '9';
  reseal(bytes);
  return bytes;
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

/// An asset of one channel per part as another tool saves it: the same attributes and pixels, with
/// the header changed; all parts but the one named, if any.
std::string resaved(const std::string& bytes, const std::function<void(Imf::Header&)>& change,
                    const std::string& without = {}) {
  const TemporaryFolder folder;
  write_bytes(folder.path("in"), bytes);
  {
    Imf::MultiPartInputFile in(folder.path("in").c_str());
    std::vector<int> kept;
    std::vector<Imf::Header> headers;
    for (int part = 0; part < in.parts(); ++part) {
      if (in.header(part).name() == without) continue;
      kept.push_back(part);
      headers.push_back(in.header(part));
      change(headers.back());
    }
    // The description stays on the first part.
    for (auto at = in.header(0).begin(); at != in.header(0).end(); ++at) {
      if (std::string(at.name()).starts_with("spm")) headers[0].insert(at.name(), at.attribute());
    }
    const int count = static_cast<int>(kept.size());
    Imf::MultiPartOutputFile out(folder.path("out").c_str(), headers.data(), count);
    for (int part = 0; part < count; ++part) {
      Imf::TiledInputPart from(in, kept[static_cast<std::size_t>(part)]);
      Imf::TiledOutputPart to(out, part);
      const Imf::Header& header = headers[static_cast<std::size_t>(part)];
      const int width = header.dataWindow().max.x + 1, height = header.dataWindow().max.y + 1;
      std::vector<std::uint32_t> pixels(static_cast<std::size_t>(width * height));
      const Imf::PixelType type = header.channels().begin().channel().type;
      const std::size_t size = type == Imf::HALF ? 2 : 4;
      Imf::FrameBuffer buffer;
      buffer.insert("Y", Imf::Slice(type, reinterpret_cast<char*>(pixels.data()), size,
                                    size * static_cast<std::size_t>(width)));
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

/// An asset without one of its parts, the others aligned as before.
std::string without_part(const std::string& bytes, const std::string& name) {
  std::string saved;
  for (std::size_t pad = 1; pad <= 8; ++pad) {
    std::string padding(pad, ' ');
    const auto pad_first = [&padding](Imf::Header& header) {
      if (!padding.empty()) header.insert("spm_without", Imf::StringAttribute(padding));
      padding.clear();
    };
    saved = resaved(bytes, pad_first, name);
    bool aligned = true;
    for (const HandPart& part : read_by_hand(saved).parts) {
      for (const std::uint64_t start : part.table) {
        aligned = aligned && (start + 24) % part.sample_bytes == 0;
      }
    }
    if (aligned) return saved;
  }
  FAIL("no alignment without " << name);
  return saved;
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
      {"a part of an unknown name", with_header_text(sparse, "grid_lists", "grid_lusts"),
       "grid_lusts"},
      {"a channel renamed", with_header_text(full, "hit10.Y", "hit10.Z"), "heights12"},
  };
}

/// Each file without one of its parts.
std::vector<Damage> missing_parts() {
  std::vector<Damage> cases;
  for (const std::string& bytes : {sparse_bytes(), baked(full_asset(1, {1, 1, 1}))}) {
    for (const HandPart& part : read_by_hand(bytes).parts) {
      const std::string name = part.name();
      std::string cause = "part " + name + " is missing or not as the asset describes it";
      // Maps and masks are told by what misses its own.
      if (name == "heights01") cause = "tile 0 of plane 0 does not exist";
      cases.push_back({"without " + name, without_part(bytes, name), cause});
    }
  }
  return cases;
}

std::vector<Damage> wrong_descriptions() {
  const std::string sparse = sparse_bytes();
  const std::string full = full_bytes();
  const std::string lists = std::to_string(sparse_asset(1).octree.lists.size());
  return {
      {"the version before",
       with_header_text(sparse, "\"format_version\":13", "\"format_version\":4 "),
       "format version 4, this program reads 13; an older spm-bake wrote it; bake it again"},
      {"tolerance NaN",
       with_header_text(sparse, "\"tolerance\":3.3333333333333335e-05",
                        "\"tolerance\":NaN                   "),
       "not a JSON object"},
      {"tolerance negative", with_header_text(sparse, "\"tolerance\":3.3", "\"tolerance\":-33"),
       "`tolerance`"},
      {"units of millimetres", with_header_text(sparse, "\"units\":\"m\"", "\"units\":\"k\""),
       "`units`"},
      {"a map too many", with_header_text(sparse, "\"charts\":6", "\"charts\":7"), "grid_maps"},
      {"other columns", with_header_text(full, "\"columns\":9", "\"columns\":8"), "part "},
      {"triangles of another number", with_other_number(sparse, "exact", "triangles"), "triangles"},
      {"corners of another number", with_other_number(sparse, "exact", "corners"),
       "triangles_corners"},
      {"a grid of other size", with_header_text(full, "\"cells\":[7,7,5]", "\"cells\":[7,7,9]"),
       "grid_index"},
      {"lists of other size", with_other_number(full, "grid", "records"), "grid_records"},
      {"an octree of other size",
       with_header_text(sparse, "\"roots\":[4,4,3]", "\"roots\":[4,4,4]"), "grid_roots"},
      {"cubes of another number", with_other_number(sparse, "octree", "words"), "grid_cubes"},
      {"lists of another length",
       with_header_text(sparse, "\"lists\":" + lists,
                        "\"lists\":" + std::string(lists.size(), '9')),
       "grid_lists"},
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
  const std::string sparse = sparse_bytes();
  const std::string full = full_bytes();
  Asset of_halves = sparse_asset(1);
  of_halves.atlas.halves = true;
  const std::string halves = baked(of_halves);
  constexpr std::uint32_t nan = 0x7FC00000, infinity = 0x7F800000;
  // Of the second map.
  const auto with_chart_word = [&sparse](std::uint64_t which, std::uint32_t word) {
    return with_word(sparse, flat_word(sparse, "grid_maps", chart_word_count + which), word);
  };
  return {
      {"a map of no plane", with_chart_word(0, 10), "distance map 1 names a plane"},
      {"a map of no level", with_chart_word(0, 32U << 16U), "distance map 1 has a level"},
      {"a map of no size", with_chart_word(2, 2), "distance map 1 has a size"},
      {"a map outside the picture", with_chart_word(3, 1000), "distance map 1 lies outside"},
      {"a map of a NaN base", with_chart_word(4, nan), "distance map 1 has a base"},
      {"a map of an infinite HALF height",
       with_word(halves, flat_word(halves, "heights", 20), 0x3C007C00), "not numbers"},
      {"a map of NaN height", with_word(sparse, flat_word(sparse, "heights", 40), nan),
       "heights that are not numbers"},
      {"a map of infinite height", with_word(sparse, flat_word(sparse, "heights", 40), infinity),
       "heights that are not numbers"},
      {"a NaN sample in a full asset", with_word(full, flat_word(full, "heights02", 3), nan),
       "not numbers"},
      {"a triangle at infinity in a full asset",
       with_word(full, flat_word(full, "triangles", 8), infinity), "triangles"},
  };
}

}  // namespace

TEST_CASE("A file that never was an asset is told what it is not") {
  check_all_refused(foreign_files());
}

TEST_CASE("An asset whose layout was changed is refused, its checksum made right or not") {
  check_all_refused(structural_damage());
}

TEST_CASE("An asset without any one of its parts is refused, and told which one") {
  const std::vector<Damage> cases = missing_parts();
  CHECK(cases.size() == 13);
  check_all_refused(cases);
}

TEST_CASE("An asset whose description was changed is refused") {
  check_all_refused(wrong_descriptions());
}

TEST_CASE("An asset whose maps or triangles were changed is refused") {
  check_all_refused(wrong_content());
}

TEST_CASE("An asset cut short anywhere is refused as cut short") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  const std::string bytes = sparse_bytes();
  Random random(4);
  std::vector<std::size_t> lengths{5, 8, 9, 100, 1000, 4096, bytes.size() / 2, bytes.size() - 1};
  for (int k = 0; k < 40; ++k)
    lengths.push_back(5 + below(random, static_cast<std::uint32_t>(bytes.size() - 5)));
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
          below(random, k % 2 == 0 ? header : static_cast<std::uint32_t>(bytes.size()));
      std::string flipped = bytes;
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << below(random, 8)));
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
  const TemporaryFolder folder;
  REQUIRE(::chmod(folder.folder().c_str(), 0755) == 0);
  for (const auto& [name, mode] : {std::pair{"open.spm.exr", 0644}, {"closed.spm.exr", 0}}) {
    write_bytes(folder.path(name), sparse_bytes());
    REQUIRE(::chmod(folder.path(name).c_str(), static_cast<mode_t>(mode)) == 0);
  }
  const AsNobody user;
  if (!user.works()) SPM_SKIP("root cannot become another user here");
  REQUIRE(MappedAsset::open(folder.path("open.spm.exr")).has_value());
  const auto opened = MappedAsset::open(folder.path("closed.spm.exr"));
  REQUIRE(!opened);
  CHECK(opened.error().code == ExitCode::file_or_device);
}

}  // namespace damaged_asset_test
