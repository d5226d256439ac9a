// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>

#include "formats/asset/asset.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/files/output_file.hpp"
#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/as_nobody.hpp"
#include "tests/support/skip.hpp"

namespace output_test {

namespace {

using namespace spm;
using namespace spm::test;
using Names = std::vector<std::string>;

/// Files may not grow beyond `bytes` in its scope: a full disk, as far as a writer can tell.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

}  // namespace

TEST_CASE("A write that fails half way leaves nothing behind and says why") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  for (const rlim_t limit : {rlim_t{0}, rlim_t{1000}, rlim_t{20000}}) {
    Result<AssetBytes> written = [&] {
      const FileSizeLimit full_disk(limit);
      return write_asset(sparse_asset(1), path);
    }();
    REQUIRE(!written);
    CHECK(written.error().code == ExitCode::file_or_device);
    CHECK(written.error().message.find(path) == 0);
    CHECK(written.error().message.find("free some space") != std::string::npos);
    CHECK(folder.entries().empty());
  }
}

TEST_CASE("A write that fails leaves the file that was there") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.spm.exr");
  REQUIRE(write_asset(sparse_asset(1), path).has_value());
  const std::string before = read_bytes(path);
  {
    const FileSizeLimit full_disk(20000);
    CHECK(!write_asset(sparse_asset(2), path).has_value());
  }
  CHECK((read_bytes(path) == before));
  CHECK(folder.entries() == Names{"a.spm.exr"});
  CHECK(MappedAsset::open(path).has_value());
}

TEST_CASE("A path that cannot be written is refused before the bake") {
  const TemporaryFolder folder;
  REQUIRE(::mkdir(folder.path("folder").c_str(), 0777) == 0);
  write_bytes(folder.path("file"), "x");
  REQUIRE(::mkfifo(folder.path("pipe").c_str(), 0666) == 0);
  for (const std::string& path :
       {std::string(), folder.path("missing/a.exr"), folder.path("folder"), folder.path("folder/"),
        folder.path("file/a.exr"), folder.path("pipe"), folder.path(std::string(300, 'n'))}) {
    INFO(path);
    const auto checked = check_output_path(path);
    REQUIRE(!checked);
    CHECK(checked.error().code == ExitCode::file_or_device);
    CHECK(checked.error().message.find(path) != std::string::npos);
    CHECK(checked.error().message.find("; ") != std::string::npos);
  }
  CHECK(folder.entries() == Names{"file", "folder", "pipe"});
}

TEST_CASE("A folder without permission to write is refused before the bake") {
  const TemporaryFolder folder;
  REQUIRE(::chmod(folder.folder().c_str(), 0777) == 0);
  REQUIRE(::mkdir(folder.path("locked").c_str(), 0555) == 0);
  const AsNobody user;
  if (!user.works()) SPM_SKIP("root cannot become another user here");
  CHECK(check_output_path(folder.path("a.exr")).has_value());
  CHECK(!check_output_path(folder.path("locked/a.exr")).has_value());
}

TEST_CASE("A path that can be written is accepted and stays untouched") {
  const TemporaryFolder folder;
  CHECK(check_output_path(folder.path("a.exr")).has_value());
  CHECK(folder.entries().empty());
  write_bytes(folder.path("b.exr"), "old");
  CHECK(check_output_path(folder.path("b.exr")).has_value());
  CHECK(read_bytes(folder.path("b.exr")) == "old");
}

TEST_CASE("An asset that contradicts itself is not written") {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.exr");
  std::vector<Asset> wrong(24, sparse_asset(1));
  wrong[0] = full_asset(1, {2, 1});
  wrong[0].grid.index.pop_back();
  wrong[1].atlas.charts[3].columns = 2;
  wrong[2].atlas.charts[3].plane = 10;
  wrong[3].metadata.options = "[1]";
  wrong[4].triangles.assign(9, 0);  // floats are of the other form
  wrong[5].atlas.charts[3].level = 32;
  wrong[6].atlas.heights.pop_back();
  wrong[7].atlas.width = 0;
  wrong[8].atlas.charts.clear();
  wrong[9].atlas.spacing = 0;
  wrong[10].octree.sides.pop_back();
  wrong[11].maps.resize(1);
  wrong[12] = full_asset(1, {2, 1});
  wrong[12].maps[1].samples.pop_back();
  wrong[13] = full_asset(1, {2, 1});
  wrong[13].maps[1].mask.clear();
  wrong[14] = full_asset(1, {2, 1});
  wrong[14].atlas = sparse_asset(1).atlas;
  // An octree without a word for each root or without whole triangles, or of the other form.
  wrong[15].octree.root_words.clear();
  wrong[16].octree.triangles.pop_back();
  wrong[17].octree.roots[2] += 1;
  wrong[18].grid = full_asset(1, {2, 1}).grid;
  wrong[19].grid.records.push_back(0);
  wrong[20] = full_asset(1, {2, 1});
  wrong[20].octree = sparse_asset(1).octree;
  wrong[21] = full_asset(1, {2, 1});
  wrong[21].octree.triangles = sparse_asset(1).octree.triangles;
  wrong[22] = full_asset(1, {2, 1});
  wrong[22].grid = {};
  wrong[23] = full_asset(1, {2, 1});
  wrong[23].triangles.pop_back();
  for (std::size_t k = 0; k < wrong.size(); ++k) {
    INFO("wrong[" << k << "]");
    const auto written = write_asset(wrong[k], path);
    REQUIRE(!written);
    CHECK(written.error().code == ExitCode::internal);
  }
  CHECK(folder.entries().empty());
}

TEST_CASE("write_file replaces a file whole") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.path("a"), "one").has_value());
  REQUIRE(write_file(folder.path("a"), "two").has_value());
  CHECK(read_bytes(folder.path("a")) == "two");
  CHECK(folder.entries() == Names{"a"});
}

}  // namespace output_test
