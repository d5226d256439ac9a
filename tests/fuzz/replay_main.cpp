// SPDX-License-Identifier: Apache-2.0
// A fuzz target without libFuzzer: gives it its seeds, changed ones, and files.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/base/random.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/support/skip.hpp"

namespace {

namespace fs = std::filesystem;

constexpr int changed_of_each = 200;

void run(const std::string& bytes) {
  // A copy of exactly this size, so that a sanitizer sees what is read beyond it.
  const std::vector<std::uint8_t> input(bytes.begin(), bytes.end());
  LLVMFuzzerTestOneInput(input.data(), input.size());
}

std::size_t up_to(spm::Random& random, std::size_t most) {
  return std::min(most, static_cast<std::size_t>(random.between(0, 1 + static_cast<double>(most))));
}

/// Cut, with a part doubled, or with some bytes exchanged.
std::string changed(std::string bytes, spm::Random& random) {
  const std::size_t at = up_to(random, bytes.size());
  const double kind = random.between(0, 10);
  if (kind < 1) return bytes.substr(0, at);
  if (kind < 2) return bytes.insert(at, bytes.substr(at / 2, up_to(random, bytes.size() - at / 2)));
  for (std::size_t count = 1 + up_to(random, 7); count > 0 && !bytes.empty(); --count) {
    bytes[up_to(random, bytes.size() - 1)] = static_cast<char>(up_to(random, 255));
  }
  return bytes;
}

int run_seeds() {
  spm::Random random(1);
  std::size_t inputs = 0;
  for (const std::string& seed : spm::fuzz::seeds()) {
    run(seed);
    for (int i = 0; i < changed_of_each; ++i) run(changed(seed, random));
    inputs += 1 + changed_of_each;
  }
  std::printf("%zu inputs\n", inputs);
  return inputs > 0 ? 0 : 1;
}

int run_files(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    std::printf("SKIPPED: there is no folder %s\n", folder.c_str());
    return spm::test::skip_code;
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const auto is_input = [&](const std::string& ending) { return name.ends_with(ending); };
    const std::vector<std::string> endings = spm::fuzz::endings();
    if (std::none_of(endings.begin(), endings.end(), is_input)) continue;
    std::printf("%s\n", name.c_str());
    std::fflush(stdout);
    run(spm::fuzz::bytes_of(entry.path().string()));
  }
  return 0;
}

int write_seeds(const fs::path& folder) {
  fs::create_directories(folder);
  int number = 0;
  for (const std::string& seed : spm::fuzz::seeds()) {
    std::ofstream(folder / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count == 1) return run_seeds();
  if (count == 3 && std::strcmp(words[1], "--files") == 0) return run_files(words[2]);
  if (count == 3 && std::strcmp(words[1], "--write-seeds") == 0) return write_seeds(words[2]);
  std::fprintf(stderr, "usage: %s [--files FOLDER | --write-seeds FOLDER]\n", words[0]);
  return 1;
}
