// SPDX-License-Identifier: Apache-2.0
#include "formats/cli/byte_size.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace spm::cli {

Result<std::uint64_t> parse_byte_size(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, double>, 9> units{{{"B", 1},
                                                                      {"kB", 1e3},
                                                                      {"MB", 1e6},
                                                                      {"GB", 1e9},
                                                                      {"TB", 1e12},
                                                                      {"KiB", 0x1p10},
                                                                      {"MiB", 0x1p20},
                                                                      {"GiB", 0x1p30},
                                                                      {"TiB", 0x1p40}}};
  constexpr double largest = 0x1p60;
  double number = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  const std::string_view unit(parsed.ptr, static_cast<std::size_t>(end - parsed.ptr));
  if (parsed.ec == std::errc() && number >= 0) {
    for (const auto& [name, factor] : units) {
      if (unit == name && number * factor < largest) {
        return static_cast<std::uint64_t>(std::llround(number * factor));
      }
    }
  }
  return fail(ExitCode::usage,
              "'" + text + "' will not do: write a number and its unit, such as 500MB or 10GB");
}

}  // namespace spm::cli
