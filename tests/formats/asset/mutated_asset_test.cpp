// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "common/contact/force_law.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/formats/support/exr_by_hand.hpp"
#include "tests/formats/support/synthetic_asset.hpp"

namespace mutated_asset_test {

namespace {

using namespace spm;
using namespace spm::test;

/// Where a mutation hits hardest: headers and tables, chunk headers, and the words of the grid or
/// octree and of the triangles.
std::vector<std::pair<std::uint64_t, std::uint64_t>> sensitive_ranges(const std::string& bytes) {
  const HandFile file = read_by_hand(bytes);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges{{0, file.header_bytes}};
  std::uint64_t chunks = 0;
  for (const HandPart& part : file.parts) {
    chunks += part.table.size();
    const bool words = part.name().starts_with("grid_") || part.name() == "triangles";
    const std::uint64_t payload = std::uint64_t{part.sample_bytes} * part.tile_width *
                                  part.tile_height * part.channels.size();
    for (const std::uint64_t start : part.table) {
      ranges.emplace_back(start, start + 24 + (words ? payload : 0));
    }
  }
  ranges.emplace_back(file.header_bytes, file.header_bytes + 8 * chunks);
  return ranges;
}

std::string mutant(const std::string& bytes,
                   const std::vector<std::pair<std::uint64_t, std::uint64_t>>& ranges,
                   Random& random) {
  std::string mutated = bytes;
  const std::uint32_t changes = 1 + below(random, 3);
  for (std::uint32_t k = 0; k < changes; ++k) {
    const auto& [begin, end] = ranges[below(random, static_cast<std::uint32_t>(ranges.size()))];
    const std::uint64_t at = begin + random.next() % (end - begin);
    switch (below(random, 5)) {
      case 0:
        mutated[at] = static_cast<char>(mutated[at] ^ (1 << below(random, 8)));
        break;
      case 1:
        mutated[at] = static_cast<char>(below(random, 256));
        break;
      case 2:  // a digit of the description stays a digit
        mutated[at] = static_cast<char>('0' + below(random, 10));
        break;
      case 3:
        mutated[at] = below(random, 2) == 0 ? '\0' : '\xff';
        break;
      default:
        mutated[at] = mutated[begin + random.next() % (end - begin)];
        break;
    }
  }
  if (below(random, 20) == 0)
    mutated.resize(1 + below(random, static_cast<std::uint32_t>(mutated.size())));
  reseal(mutated);
  return mutated;
}

void use(const AssetView& view, Random& random) {
  for (int k = 0; k < 50; ++k) {
    const Vector3 point(random.between(-0.04, 0.04), random.between(-0.04, 0.04),
                        random.between(-0.03, 0.03));
    const Answer answer = query_point(view, point);
    CHECK(static_cast<int>(answer.status) <= 3);
    for (const Method method : {Method::spm, Method::paper}) {
      if (method == Method::paper && !view.full) continue;
      const ContactForce force = contact_force(view, {.method = method, .stiffness = 1000}, point);
      CHECK(force.force.allFinite());
    }
  }
}

}  // namespace

TEST_CASE("A mutated asset with a right checksum is refused, or is safe to query") {
  const TemporaryFolder folder(TemporaryFolder::Place::memory);
  const std::string path = folder.path("a.spm.exr");
  for (const Asset& asset :
       {sparse_asset(1, {.planes = 3, .triangles = 6}), full_asset(2, {2, 1, 2, 11}, 5, 4)}) {
    REQUIRE(write_asset(asset, path).has_value());
    const std::string bytes = read_bytes(path);
    const auto ranges = sensitive_ranges(bytes);
    Random random(6);
    int opened_mutants = 0, refused_mutants = 0;
    for (int k = 0; k < 2000; ++k) {
      write_bytes(path, mutant(bytes, ranges, random));
      const auto opened = MappedAsset::open(path);
      if (opened) {
        ++opened_mutants;
        use((*opened)->view(), random);
      } else {
        ++refused_mutants;
        REQUIRE(opened.error().code == ExitCode::invalid_input);
        REQUIRE(opened.error().message.find(path + ": ") == 0);
      }
    }
    CHECK(opened_mutants > 0);
    CHECK(refused_mutants > 500);
  }
}

TEST_CASE("Bytes that change under the map after the checks leave queries safe") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  for (const Asset& asset : {sparse_asset(3), full_asset(4, {2, 1, 2, 11})}) {
    REQUIRE(write_asset(asset, path).has_value());
    const std::string bytes = read_bytes(path);
    const auto opened = MappedAsset::open(path);
    REQUIRE(opened.has_value());
    Random random(8);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    for (int k = 0; k < 200; ++k) {
      std::string block(512, '\0');
      for (char& byte : block) byte = static_cast<char>(below(random, 256));
      file.seekp(below(random, static_cast<std::uint32_t>(bytes.size() - block.size())));
      file.write(block.data(), static_cast<std::streamsize>(block.size())).flush();
      use((*opened)->view(), random);
    }
    CHECK((*opened)->check_file() == AssetState::edited);
  }
}

TEST_CASE("An octree of any words at all, opened by force, leaves queries within it") {
  const Asset whole = sparse_asset(5, {.planes = 3, .triangles = 40});
  Random random(9);
  int answers = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Asset asset = whole;
    OctreeData& octree = asset.octree;
    const bool all = trial % 4 == 0;
    for (std::vector<std::uint32_t>* words : {&octree.root_words, &octree.words, &octree.lists,
                                              &octree.corners, &octree.triangles, &octree.sides}) {
      if (below(random, 3) == 0) words->resize(below(random, 60));
      words->shrink_to_fit();
      for (std::uint32_t& word : *words) {
        if (all || below(random, 8) == 0) word = static_cast<std::uint32_t>(random.next());
        if (below(random, 8) == 0) word &= 0xFF00000FU;  // nearer to what may be there
      }
    }
    const AssetTables tables = tables_of(asset);
    std::array<Vector3, 50> points;
    for (Vector3& point : points) {
      point = Vector3(random.between(-0.05, 0.05), random.between(-0.05, 0.05),
                      random.between(-0.04, 0.04));
    }
    std::array<Answer, 50> together;
    query_points(tables.view(), points, together);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Answer answer = query_point(tables.view(), points[k]);
      const bool answered = answer.status == Status::exact || answer.status == Status::deep;
      REQUIRE(answered == std::isfinite(answer.distance));
      REQUIRE(answer.normal.allFinite());
      REQUIRE(answer.status == together[k].status);
      REQUIRE((!answered || answer.distance == together[k].distance));
      REQUIRE(clearance(tables.view(), points[k]) >= 0);
      answers += answered ? 1 : 0;
    }
  }
  CHECK(answers > 1000);
}

}  // namespace mutated_asset_test
