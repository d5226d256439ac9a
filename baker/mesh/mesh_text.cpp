// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh_text.hpp"

#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "baker/mesh/mesh_reader.hpp"

namespace spm::baker {
namespace {

constexpr std::string_view kBlank = " \t\r\v\f";

/// A word as a message quotes it: short, and printable whatever the file holds.
[[nodiscard]] std::string quoted(std::string_view word) {
  constexpr std::size_t kLongest = 24;
  std::string text = "'";
  for (const char c : word.substr(0, kLongest)) {
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return text + (word.size() > kLongest ? "...'" : "'");
}

[[nodiscard]] std::string_view without_plus(std::string_view word) {
  return word.size() > 1 && word.front() == '+' ? word.substr(1) : word;
}

}  // namespace

std::string lower_case(std::string_view word) {
  std::string lower(word);
  for (char& letter : lower) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return lower;
}

bool is_utf16(std::string_view bytes) {
  return bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
}

std::string ascii_of_utf16(const std::string& path, std::string_view bytes) {
  if (bytes.size() % 2 != 0) {
    refuse_file(path + ": byte " + std::to_string(bytes.size() - 1),
                "the text in UTF-16 ends within a letter",
                "it was cut short, copy or export the mesh again");
  }
  const std::size_t low = bytes.starts_with("\xFF\xFE") ? 0 : 1;
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t i = 2; i < bytes.size(); i += 2) {
    const char letter = bytes[i + low];
    text += bytes[i + 1 - low] == 0 && letter >= 0 ? letter : '?';
  }
  return text;
}

MeshText::MeshText(std::string path, std::string_view bytes, std::size_t start, std::size_t line)
    : path_(std::move(path)), bytes_(bytes), position_(start), line_(line) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const std::size_t zero = bytes.find('\0', start);
  if (zero != std::string_view::npos) {
    refuse_file(path_ + ": byte " + std::to_string(zero), "binary data where text is expected",
                "the file is damaged or of another format, export the mesh again");
  }
  if (start == 0 && bytes.starts_with(kByteOrderMark)) position_ = kByteOrderMark.size();
}

bool MeshText::next_line() {
  while (position_ < bytes_.size()) {
    // A lone carriage return ends a line too, as old exporters write it.
    const std::size_t end = std::min(bytes_.find_first_of("\r\n", position_), bytes_.size());
    rest_ = bytes_.substr(position_, end - position_);
    position_ = bytes_.substr(end).starts_with("\r\n") ? end + 2 : std::min(end + 1, bytes_.size());
    ++line_;
    rest_ = rest_.substr(0, rest_.find('#'));
    if (rest_.find_first_not_of(kBlank) != std::string_view::npos) return true;
  }
  rest_ = {};
  return false;
}

std::string_view MeshText::next_word() {
  const std::size_t begin = rest_.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return rest_ = {};
  const std::size_t end = std::min(rest_.find_first_of(kBlank, begin), rest_.size());
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_ = rest_.substr(end);
  return word;
}

std::string_view MeshText::next_word_anywhere(std::string_view what) {
  std::string_view word = next_word();
  while (word.empty()) {
    if (!next_line()) fail_cut_short(what);
    word = next_word();
  }
  return word;
}

Vector3 MeshText::point(const std::string& cure) {
  Vector3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = next_word();
    if (word.empty()) {
      fail("vertex has " + std::to_string(axis) + " coordinates instead of 3", cure);
    }
    point[axis] = number(word, "coordinate");
  }
  return point;
}

double MeshText::number(std::string_view word, std::string_view what) const {
  const std::string_view digits = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    fail(std::string(what) + " " + quoted(word) + " is no number", "export the mesh again");
  }
  if (error == std::errc::result_out_of_range && word.find("e-") == std::string_view::npos &&
      word.find("E-") == std::string_view::npos) {
    fail(std::string(what) + " " + quoted(word) + " is too large", "export the mesh again");
  }
  if (!std::isfinite(value)) {
    fail(std::string(what) + " " + quoted(word) + " is not finite",
         "remove or mend this vertex and export the mesh again");
  }
  return value;
}

std::int64_t MeshText::integer(std::string_view word, std::string_view what) const {
  const std::string_view digits = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    fail(std::string(what) + " " + quoted(word) + " is no whole number", "export the mesh again");
  }
  return value;
}

void MeshText::fail(const std::string& cause, const std::string& cure) const {
  fail_at(line_, cause, cure);
}

void MeshText::fail_at(std::size_t line, const std::string& cause, const std::string& cure) const {
  refuse_file(path_ + ": line " + std::to_string(line), cause, cure);
}

void MeshText::fail_cut_short(std::string_view missing) const {
  fail("the file ends before " + std::string(missing),
       "it was cut short, copy or export the mesh again");
}

}  // namespace spm::baker
