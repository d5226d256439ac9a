// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/gunzip.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/mesh_reader.hpp"

namespace spm::baker {
namespace {

constexpr std::size_t most_bytes = std::size_t{4} << 30U;
constexpr std::size_t block_bytes = std::size_t{1} << 20U;
constexpr int with_gzip_header = 16;  // added to the size of the window

/// A stream that ends with its scope.
struct Inflation {
  z_stream stream{};
  bool ready = inflateInit2(&stream, MAX_WBITS + with_gzip_header) == Z_OK;

  Inflation() = default;
  ~Inflation() {
    if (ready) inflateEnd(&stream);
  }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;
};

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string gunzip(const std::string& path, std::string_view bytes) {
  Inflation inflation;
  z_stream& stream = inflation.stream;
  if (!inflation.ready) throw BakeError(ExitCode::internal, path + ": no memory to unpack it");
  std::string unpacked;
  std::vector<Bytef> block(block_bytes);
  std::string_view rest = bytes;
  for (;;) {
    const auto some =
        static_cast<uInt>(std::min<std::size_t>(rest.size(), std::numeric_limits<uInt>::max()));
    // zlib does not write to its input.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest.data()));
    stream.avail_in = some;
    stream.next_out = block.data();
    stream.avail_out = static_cast<uInt>(block.size());
    const int code = inflate(&stream, Z_NO_FLUSH);
    rest.remove_prefix(some - stream.avail_in);
    unpacked.append(reinterpret_cast<const char*>(block.data()), block.size() - stream.avail_out);
    const std::string place = path + ": byte " + std::to_string(bytes.size() - rest.size());
    if (unpacked.size() > most_bytes) {
      refuse_file(place, "more than 4 GiB come out of it", "bake a smaller mesh");
    }
    if (unpacked.size() > always_unpacked &&
        unpacked.size() / most_growth > bytes.size() - rest.size()) {
      refuse_file(place, "what comes out is more than 100 times as large, which no mesh is",
                  "unpack it yourself and look at it");
    }
    if (code == Z_STREAM_END) {
      if (!is_gzip(rest)) return unpacked;  // what follows the last member is padding
      if (inflateReset(&stream) != Z_OK) throw BakeError(ExitCode::internal, place);
    } else if (code == Z_BUF_ERROR && rest.empty()) {
      refuse_file(place, "the gzip file is cut short", "copy or compress it again");
    } else if (code != Z_OK) {
      refuse_file(place, "the gzip data is damaged", "copy or compress it again");
    }
  }
}

}  // namespace spm::baker
