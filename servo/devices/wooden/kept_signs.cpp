// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/kept_signs.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <span>
#include <system_error>

namespace spm::servo {

namespace {

namespace fs = std::filesystem;

/// A serial number is the device's word: any other character becomes its number, so that it names
/// no other folder.
fs::path file_of(const std::string& folder, const WoodenBoard& board) {
  std::string name;
  for (const char c : board.serial) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    name += plain ? std::string(1, c) : fmt::format("_{:02x}", static_cast<unsigned char>(c));
  }
  return fs::path(folder) / (name + ".signs");
}

std::string text_of(std::span<const std::int8_t> signs) {
  std::string text;
  for (const std::int8_t sign : signs) text += sign < 0 ? '-' : '+';
  return text;
}

bool read(std::string_view text, std::span<std::int8_t> signs) {
  if (text.size() != signs.size()) return false;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    if (text[i] != '+' && text[i] != '-') return false;
    signs[i] = text[i] == '-' ? -1 : 1;
  }
  return true;
}

tl::unexpected<Error> not_kept(const std::string& why) {
  return fail(ExitCode::file_or_device,
              "the signs of the WoodenHaptics cannot be kept: " + why +
                  ", or leave keep_signs=on away and name signs= at each start");
}

}  // namespace

std::optional<WoodenSigns> kept_signs(const std::string& folder, const WoodenBoard& board) {
  if (folder.empty() || board.serial.empty()) return std::nullopt;
  std::ifstream file(file_of(folder, board));
  std::string model, protocol, counts, motors, more;
  if (!(file >> model >> protocol >> counts >> motors) || file >> more) return std::nullopt;
  WoodenSigns signs;
  const bool is_good = model == board.model && protocol == to_string(board.protocol) &&
                       read(counts, signs.counts) && read(motors, signs.motors);
  return is_good ? std::optional(signs) : std::nullopt;
}

Result<void> keep_signs(const std::string& folder, const WoodenBoard& board,
                        const WoodenSigns& signs) {
  if (folder.empty()) {
    return not_kept("there is no folder for it; set XDG_STATE_HOME or HOME to a folder of yours");
  }
  if (board.serial.empty()) {
    return not_kept("it has no serial number; give its board one in its firmware");
  }
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  const fs::path path = file_of(folder, board);
  const fs::path whole = path.string() + ".new";
  std::ofstream file(whole);
  file << fmt::format("{} {} {} {}\n", board.model, to_string(board.protocol),
                      text_of(signs.counts), text_of(signs.motors));
  file.close();
  std::error_code failed;
  if (file) fs::rename(whole, path, failed);
  if (!file || failed) {
    return not_kept(
        fmt::format("{} cannot be written; check its folder's permissions", path.string()));
  }
  return {};
}

WoodenSigns signs_of(const WoodenCalibration& calibration) noexcept {
  WoodenSigns signs;
  for (std::size_t i = 0; i < signs.counts.size(); ++i) {
    signs.counts[i] = calibration.count_signs[i] < 0 ? -1 : 1;
  }
  for (std::size_t i = 0; i < signs.motors.size(); ++i) {
    signs.motors[i] = calibration.motor_signs[i] < 0 ? -1 : 1;
  }
  return signs;
}

void take_signs(const WoodenSigns& signs, WoodenCalibration& calibration) noexcept {
  for (std::size_t i = 0; i < signs.counts.size(); ++i) {
    calibration.count_signs[i] = signs.counts[i];
  }
  for (std::size_t i = 0; i < signs.motors.size(); ++i) {
    calibration.motor_signs[i] = signs.motors[i];
  }
}

}  // namespace spm::servo
