// SPDX-License-Identifier: Apache-2.0
#include "formats/motion/trajectory.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace spm {
namespace {

constexpr std::string_view separators = " \t\r,";
/// How the tables of `run --trace` and `replay --out` begin.
constexpr std::string_view table_start = "t,x,y,z,fx,fy,fz,";
constexpr double unit_slack = 1e-3;  // of a quaternion written with few digits

tl::unexpected<Error> at_line(const std::string& path, std::size_t line, const std::string& cause) {
  return fail(ExitCode::invalid_input, path + ": line " + std::to_string(line) + ": " + cause);
}

/// A word of a file that may be binary, made printable.
std::string printable(std::string_view word) {
  std::string text;
  for (const char character : word.substr(0, 24)) {
    text += character > ' ' && character < '\x7f' ? character : '?';
  }
  return word.size() > 24 ? text + "..." : text;
}

std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = std::min(rest.find_first_not_of(separators), rest.size());
  const std::size_t end = std::min(rest.find_first_of(separators, begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

/// The numbers of a line; nothing in `values` where it is blank.
struct Row {
  std::array<double, 7> values{};
  std::size_t count = 0;
};

Result<Row> parse_row(std::string_view line, const std::string& path, std::size_t number) {
  Row row;
  for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
    if (row.count == row.values.size()) {
      return at_line(path, number, "more than seven numbers; give x y z or x y z qw qx qy qz");
    }
    const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
    double value = 0;
    const auto [end, problem] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (problem != std::errc() || end != digits.data() + digits.size()) {
      return at_line(path, number, printable(word) + " is not a number; give x y z in metres");
    }
    if (!std::isfinite(value)) {
      return at_line(path, number, "a coordinate is not finite; remove the line or mend it");
    }
    row.values[row.count++] = value;
  }
  if (row.count != 0 && row.count != 3 && row.count != 7) {
    return at_line(path, number,
                   std::to_string(row.count) + (row.count == 1 ? " number" : " numbers") +
                       "; give x y z or x y z qw qx qy qz");
  }
  return row;
}

Result<TrajectorySample> sample_of(const Row& row, const std::string& path, std::size_t number) {
  TrajectorySample sample;
  const auto& v = row.values;
  sample.position = Vector3(v[0], v[1], v[2]);
  if (row.count == 7) {
    const double norm = std::hypot(std::hypot(v[3], v[4]), std::hypot(v[5], v[6]));
    if (!(std::abs(norm - 1) <= unit_slack)) {
      return at_line(path, number,
                     "its quaternion is not of unit length; give qw qx qy qz of unit length");
    }
    sample.qw = v[3] / norm;
    sample.qx = v[4] / norm;
    sample.qy = v[5] / norm;
    sample.qz = v[6] / norm;
  }
  return sample;
}

Result<std::string> read_text(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) {
    return fail(ExitCode::file_or_device, path + ": is a folder; give a text file of points");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return fail(ExitCode::file_or_device, path + ": cannot be opened: " + std::strerror(errno) +
                                              "; check the path and its permissions");
  }
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) {
    return fail(ExitCode::file_or_device, path + ": cannot be read; check the disk");
  }
  return text;
}

}  // namespace

Result<std::vector<TrajectorySample>> read_trajectory(const std::string& path) {
  const Result<std::string> text = read_text(path);
  if (!text) return tl::make_unexpected(text.error());
  if (text->starts_with(table_start)) {
    return fail(
        ExitCode::invalid_input,
        path +
            ": line 1: this is a table of forces, as run --trace and replay --out write it, "
            "and no recording: run with --record FILE and replay that, or keep the positions "
            "alone by: tail -n +2 TABLE | cut -d, -f2-4 > POSITIONS.txt");
  }
  std::vector<TrajectorySample> samples;
  std::string_view rest = *text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line = line.substr(0, line.find('#'));
    const Result<Row> row = parse_row(line, path, number);
    if (!row) return tl::make_unexpected(row.error());
    if (row->count == 0) continue;
    const Result<TrajectorySample> sample = sample_of(*row, path, number);
    if (!sample) return tl::make_unexpected(sample.error());
    samples.push_back(*sample);
  }
  if (samples.empty()) {
    return fail(ExitCode::invalid_input,
                path + ": holds no points; give at least one line of x y z in metres");
  }
  return samples;
}

}  // namespace spm
