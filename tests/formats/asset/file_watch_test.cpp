// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>

#include "common/query/query.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/files/sha256.hpp"
#include "tests/formats/support/synthetic_asset.hpp"

namespace file_watch_test {

namespace {

using namespace spm;
using namespace spm::test;

/// A written asset of some hundred pages.
struct Opened {
  TemporaryFolder folder;
  std::string path = folder.path("a.spm.exr");
  Asset asset = sparse_asset(1, {.charts = 1000});
  std::unique_ptr<MappedAsset> mapped;

  explicit Opened(MapMode mode = MapMode::file) {
    REQUIRE(write_asset(asset, path).has_value());
    auto opened = MappedAsset::open(path, {.mode = mode});
    REQUIRE(opened.has_value());
    mapped = std::move(*opened);
    REQUIRE(mapped->check_file() == AssetState::intact);
  }
};

double sum_of_samples(const AssetView& view) {
  double sum = 0;
  for (std::size_t k = 0; k < view.atlas.count; ++k) {
    sum += std::abs(static_cast<double>(view.atlas.at(k)));
  }
  return sum;
}

/// Queries everywhere; the answers do not matter, only that there are answers.
int count_answers(const AssetView& view) {
  Random random(1);
  int answers = 0;
  for (int k = 0; k < 5000; ++k) {
    const Vector3 point(random.between(-0.04, 0.04), random.between(-0.04, 0.04),
                        random.between(-0.03, 0.03));
    answers += query_point(view, point).status == Status::exact ? 1 : 0;
  }
  return answers;
}

void overwrite(const std::string& path, off_t offset, const std::string& bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  REQUIRE(file >= 0);
  CHECK(::pwrite(file, bytes.data(), bytes.size(), offset) == static_cast<ssize_t>(bytes.size()));
  ::close(file);
}

}  // namespace

TEST_CASE("An asset that is truncated under the map reads as zeros and is lost, without a crash") {
  for (const off_t size : {off_t{0}, off_t{1}, off_t{4096}, off_t{100000}}) {
    const Opened opened;
    CHECK(!opened.mapped->lost());
    REQUIRE(::truncate(opened.path.c_str(), size) == 0);
    CHECK(opened.mapped->check_file() == AssetState::truncated);
    count_answers(opened.mapped->view());
    CHECK(sum_of_samples(opened.mapped->view()) < sum_of_samples(tables_of(opened.asset).view()));
    CHECK(opened.mapped->lost());
    CHECK(opened.mapped->check_file() == AssetState::truncated);
  }
}

TEST_CASE("An asset that is truncated and grown again is still told from the baked one") {
  const Opened opened;
  const std::string bytes = read_bytes(opened.path);
  write_bytes(opened.path, bytes.substr(0, bytes.size() / 2) + std::string(bytes.size() / 2, 'x'));
  CHECK(opened.mapped->check_file() != AssetState::intact);
  count_answers(opened.mapped->view());
}

TEST_CASE("An edited asset is told, even when its size and times are as before") {
  const Opened opened;
  struct stat before {};
  REQUIRE(::stat(opened.path.c_str(), &before) == 0);
  overwrite(opened.path, 50000, "changed");
  const timespec times[2] = {before.st_atim, before.st_mtim};
  REQUIRE(::utimensat(AT_FDCWD, opened.path.c_str(), times, 0) == 0);
  CHECK(opened.mapped->check_file() == AssetState::edited);
  count_answers(opened.mapped->view());
}

TEST_CASE("An asset that grew is told as edited") {
  const Opened opened;
  overwrite(opened.path, static_cast<off_t>(read_bytes(opened.path).size()), "more");
  CHECK(opened.mapped->check_file() == AssetState::edited);
}

TEST_CASE("A replaced asset is told, and the old bytes stay") {
  const Opened opened;
  const double before = sum_of_samples(opened.mapped->view());
  REQUIRE(write_asset(sparse_asset(2), opened.path).has_value());
  CHECK(opened.mapped->check_file() == AssetState::replaced);
  CHECK(sum_of_samples(opened.mapped->view()) == before);
  CHECK(!opened.mapped->lost());
}

TEST_CASE("A deleted asset is told, and the old bytes stay") {
  const Opened opened;
  const double before = sum_of_samples(opened.mapped->view());
  REQUIRE(::unlink(opened.path.c_str()) == 0);
  CHECK(opened.mapped->check_file() == AssetState::deleted);
  CHECK(sum_of_samples(opened.mapped->view()) == before);
}

TEST_CASE("Other permissions, another link and a read leave an asset intact") {
  const Opened opened;
  REQUIRE(::chmod(opened.path.c_str(), 0444) == 0);
  CHECK(opened.mapped->check_file() == AssetState::intact);
  REQUIRE(::link(opened.path.c_str(), opened.folder.path("link").c_str()) == 0);
  CHECK(opened.mapped->check_file() == AssetState::intact);
  CHECK(!read_bytes(opened.path).empty());
  CHECK(opened.mapped->check_file() == AssetState::intact);
}

TEST_CASE("A sealed map keeps its bytes whatever becomes of the file") {
  const Opened opened(MapMode::sealed);
  const double before = sum_of_samples(opened.mapped->view());
  const std::string hash = opened.mapped->content_sha256();
  overwrite(opened.path, 50000, std::string(10000, '\x7f'));
  CHECK(opened.mapped->check_file() == AssetState::edited);
  CHECK(sum_of_samples(opened.mapped->view()) == before);
  REQUIRE(::truncate(opened.path.c_str(), 0) == 0);
  CHECK(opened.mapped->check_file() == AssetState::truncated);
  CHECK(sum_of_samples(opened.mapped->view()) == before);
  CHECK(!opened.mapped->lost());
  CHECK(!hash.empty());
}

TEST_CASE("A truncated asset loses nothing of another one that is mapped") {
  const Opened one, other;
  REQUIRE(::truncate(one.path.c_str(), 0) == 0);
  CHECK(sum_of_samples(one.mapped->view()) < sum_of_samples(other.mapped->view()));
  CHECK(one.mapped->lost());
  CHECK(!other.mapped->lost());
  CHECK(sum_of_samples(other.mapped->view()) == sum_of_samples(tables_of(other.asset).view()));
}

TEST_CASE("A bus error that is not an asset's still ends the program") {
  const Opened opened;
  const std::string path = opened.folder.path("not-an-asset");
  write_bytes(path, std::string(8192, 'x'));
  const pid_t child = ::fork();
  if (child == 0) {
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    const volatile char* bytes =
        static_cast<const char*>(::mmap(nullptr, 8192, PROT_READ, MAP_SHARED, file, 0));
    if (::ftruncate(file, 0) != 0) ::_exit(1);
    ::_exit(bytes[5000]);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK((WIFSIGNALED(status) || WEXITSTATUS(status) != 0));
  CHECK(!(WIFEXITED(status) && WEXITSTATUS(status) == 'x'));
}

TEST_CASE("Assets can be opened and closed more often than there are places to guard them") {
  const Opened opened;
  for (int k = 0; k < 1500; ++k) {
    REQUIRE(MappedAsset::open(opened.path).has_value());
  }
}

TEST_CASE("A symbolic link to an asset opens") {
  const Opened opened;
  std::filesystem::create_symlink(opened.path, opened.folder.path("link.exr"));
  CHECK(MappedAsset::open(opened.folder.path("link.exr")).has_value());
}

}  // namespace file_watch_test
