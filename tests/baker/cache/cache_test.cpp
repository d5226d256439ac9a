// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cache/cache.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>

#include "baker/cache/key_lock.hpp"
#include "baker/cache/upkeep.hpp"
#include "formats/files/sha256.hpp"
#include "tests/baker/batch/batch_support.hpp"

namespace spm::baker::cache_test {
namespace {

namespace fs = std::filesystem;

/// The key and the entry of a made-up build, with an asset of so many bytes.
std::pair<std::string, CacheEntry> build(int number, std::size_t bytes = 100) {
  CacheEntry entry;
  entry.parts = {{"number", number}};
  entry.report = {{"bytes", bytes}};
  entry.warnings = {"a warning"};
  entry.asset = std::string(bytes, 'a');
  entry.asset[bytes / 2] = '\n';
  entry.asset_sha256 = sha256_bytes(entry.asset);
  return {sha256_bytes(entry.parts.dump()), entry};
}

Cache opened(const test::Folder& folder) {
  auto cache = Cache::open(folder.path("cache"));
  REQUIRE(cache);
  return *cache;
}

void store(const Cache& cache, int number, std::size_t bytes = 100) {
  const auto [digest, entry] = build(number, bytes);
  REQUIRE(cache.store(digest, entry_bytes(entry)));
}

void set_age(const Cache& cache, int number, std::chrono::hours age) {
  fs::last_write_time(cache.entry_path(build(number).first),
                      fs::file_time_type::clock::now() - age);
}

}  // namespace

TEST_CASE("An entry comes back as it was stored") {
  const test::Folder folder;
  const Cache cache = opened(folder);
  const auto [digest, entry] = build(1);
  CHECK_FALSE(cache.find(digest)->has_value());
  REQUIRE(cache.store(digest, entry_bytes(entry)));
  const auto found = opened(folder).find(digest);
  REQUIRE(found);
  REQUIRE(found->has_value());
  CHECK((*found)->asset == entry.asset);
  CHECK((*found)->report == entry.report);
  CHECK((*found)->warnings == entry.warnings);
  CHECK((*found)->asset_sha256 == entry.asset_sha256);
}

TEST_CASE("An entry with any byte changed, cut or under a foreign name is refused") {
  const test::Folder folder;
  const Cache cache = opened(folder);
  store(cache, 1);
  const auto [digest, entry] = build(1);
  const std::string path = cache.entry_path(digest);
  const auto size = fs::file_size(path);
  SECTION("changed") {
    const auto place = GENERATE_COPY(std::uintmax_t{0}, std::uintmax_t{30}, size / 2, size - 1);
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(place));
    file.put('#');
  }
  SECTION("cut") { fs::resize_file(path, GENERATE_COPY(std::uintmax_t{0}, size / 2, size - 1)); }
  SECTION("longer") { std::ofstream(path, std::ios::app) << "x"; }
  SECTION("another's") {
    store(cache, 2);
    fs::copy_file(cache.entry_path(build(2).first), path, fs::copy_options::overwrite_existing);
  }
  const auto found = cache.find(digest);
  REQUIRE_FALSE(found);
  CHECK(found.error().code == ExitCode::invalid_input);
  CHECK(verify_cache(cache).problems.size() == 1);
  cache.remove(digest);
  CHECK_FALSE(cache.find(digest)->has_value());
}

TEST_CASE("A folder that holds other things is no cache, and a missing one is none to look after") {
  const test::Folder folder;
  static_cast<void>(folder.write("full/thesis.tex", "years of work"));
  CHECK(Cache::open(folder.path("full")).error().code == ExitCode::invalid_input);
  CHECK(Cache::open(folder.path("none"), false).error().code == ExitCode::file_or_device);
  CHECK(Cache::open(folder.path("full/thesis.tex")).error().code != ExitCode::done);
  CHECK(Cache::open(folder.path("some/new/folder")).has_value());
}

TEST_CASE("Pruning removes what was not used for longest, until the rest is small enough") {
  const test::Folder folder;
  const Cache cache = opened(folder);
  for (int number = 0; number < 5; ++number) {
    store(cache, number, 10'000);
    set_age(cache, number, std::chrono::hours(10 - number));
  }
  cache.touch(build(0).first);
  const CacheStats stats = stats_of(cache);
  CHECK(stats.entries == 5);
  const CachePruning pruning = prune(cache, stats.bytes / 5 * 3);
  CHECK(pruning.removed == 2);
  CHECK(pruning.left == 3);
  for (int number = 0; number < 5; ++number) {
    CHECK(cache.has(build(number).first) == (number == 0 || number > 2));
  }
  CHECK(prune(cache, 0).left == 0);
}

TEST_CASE("Pruning takes away what killed writers left, but not what may still be written") {
  const test::Folder folder;
  const Cache cache = opened(folder);
  store(cache, 1);
  const std::string entry = cache.entry_path(build(1).first);
  for (const std::string& path : {entry + ".tmp-1-0", entry + ".tmp-2-0"}) std::ofstream(path) << 1;
  fs::last_write_time(entry + ".tmp-1-0", fs::file_time_type::clock::now() - std::chrono::hours(2));
  CHECK(stats_of(cache).leftovers == 2);
  CHECK(prune(cache, 1'000'000).removed == 0);
  CHECK_FALSE(fs::exists(entry + ".tmp-1-0"));
  CHECK(fs::exists(entry + ".tmp-2-0"));
  CHECK(cache.has(build(1).first));
}

TEST_CASE("The last key of an output is known until it changes") {
  const test::Folder folder;
  const Cache cache = opened(folder);
  const std::string output = folder.path("x.spm.exr");
  CHECK(cache.last_parts(output).is_null());
  cache.keep_parts(output, {{"seed", 1}});
  CHECK(cache.last_parts(folder.path("./x.spm.exr"))["seed"] == 1);
  CHECK(cache.last_parts(folder.path("y.spm.exr")).is_null());
}

TEST_CASE("A key that somebody bakes for is waited for, and one whose baker was killed is free") {
  const test::Folder folder;
  const std::string path = folder.path("lock");
  int ready[2], go[2];
  REQUIRE(::pipe(ready) == 0);
  REQUIRE(::pipe(go) == 0);
  const pid_t holder = ::fork();
  if (holder == 0) {
    const KeyLock lock(path);
    char letter = 'r';
    static_cast<void>(!::write(ready[1], &letter, 1));
    static_cast<void>(!::read(go[0], &letter, 1));
    ::_exit(0);  // with the lock in its hands, as if it was killed
  }
  char letter = 0;
  REQUIRE(::read(ready[0], &letter, 1) == 1);
  REQUIRE(::write(go[1], &letter, 1) == 1);
  { const KeyLock lock(path); }
  CHECK_FALSE(fs::exists(path));
  int status = 0;
  CHECK(::waitpid(holder, &status, 0) == holder);
  const KeyLock again(path);
  CHECK_FALSE(again.waited());
}

}  // namespace spm::baker::cache_test
