// SPDX-License-Identifier: Apache-2.0
#include "servo/record/black_box_files.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "servo/base/state_folder.hpp"

namespace spm::servo {

namespace {

namespace fs = std::filesystem;

/// A pattern, parted at its star.
struct Pattern {
  fs::path folder;
  std::string before, after;  ///< of the file's name
  bool has_time = false;

  explicit Pattern(const fs::path& whole) : folder(whole.parent_path()) {
    const std::string name = whole.filename().string();
    const std::size_t star = name.find('*');
    has_time = star != std::string::npos;
    before = name.substr(0, star);
    if (has_time) after = name.substr(star + 1);
  }

  /// A digit follows, so that no other daemon's files are meant, whose name begins with this one's.
  [[nodiscard]] bool fits(const std::string& name) const {
    return name.size() > before.size() + after.size() && name.starts_with(before) &&
           name.ends_with(after) && name[before.size()] >= '0' && name[before.size()] <= '9';
  }
};

void keep_the_newest(const Pattern& pattern) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (fs::directory_iterator entry(pattern.folder, ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    if (pattern.fits(entry->path().filename().string())) files.push_back(entry->path());
  }
  // Their names are in the order of time.
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i + black_boxes_kept < files.size(); ++i) fs::remove(files[i], ignored);
}

}  // namespace

std::string default_black_box(const std::string& name) {
  const std::string folder = state_folder();
  if (folder.empty()) return folder;
  return fmt::format("{}/black-box-{}-*.spmrec", folder, name.empty() ? "default" : name);
}

std::string black_box_file(const std::string& pattern, std::time_t now) {
  const Pattern parts{fs::path(pattern)};
  if (!parts.has_time) return pattern;
  const std::string time = fmt::format("{:%Y-%m-%dT%H-%M-%SZ}", fmt::gmtime(now));
  fs::path file;
  for (int number = 1; file.empty() || fs::exists(file); ++number) {
    const std::string more = number == 1 ? "" : fmt::format("_{}", number);
    file = parts.folder / (parts.before + time + more + parts.after);
  }
  return file.string();
}

Result<std::string> write_black_box(const BlackBoxMemory& memory, const std::string& pattern,
                                    std::time_t now) {
  std::string file = black_box_file(pattern, now);
  if (auto written = memory.write(file); !written) {
    return tl::make_unexpected(std::move(written.error()));
  }
  const Pattern parts{fs::path(pattern)};
  if (parts.has_time) keep_the_newest(parts);
  return file;
}

}  // namespace spm::servo
