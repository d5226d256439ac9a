// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

/// Gives some bytes to what is tried, as libFuzzer calls it. Ends the program where a promise is
/// broken.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace spm::fuzz {

/// Inputs to begin with; each target has its own.
[[nodiscard]] std::vector<std::string> seeds();
/// How names of files end that are inputs of this target.
[[nodiscard]] std::vector<std::string> endings();

/// Ends the program where a promise does not hold.
inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", promise);
  std::abort();
}

/// The bytes of a file; none where it cannot be read.
[[nodiscard]] std::string bytes_of(const std::string& path);

/// A file of the target's own, under one name.
class ScratchFile {
 public:
  ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();

  /// Replaces what is in it.
  void write(std::string_view bytes);
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  int handle_ = -1;
  std::string path_;
};

}  // namespace spm::fuzz
