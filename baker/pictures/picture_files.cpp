// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pictures/picture_files.hpp"

#include <system_error>

#include "baker/base/bake_error.hpp"
#include "formats/files/output_file.hpp"

namespace spm::baker {

std::filesystem::path make_picture_folder(const std::string& name) {
  std::filesystem::path folder(name);
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem || !std::filesystem::is_directory(folder, problem)) {
    throw BakeError(ExitCode::file_or_device, name +
                                                  ": cannot be made a folder for the pictures; "
                                                  "give --png a folder that can be written");
  }
  return folder;
}

std::string save_picture(const Picture& picture, const std::filesystem::path& path) {
  const Result<std::string> png = to_png(picture);
  if (!png) throw BakeError(png.error().code, png.error().message);
  const Result<void> written = write_file(path.string(), *png);
  if (!written) throw BakeError(written.error().code, written.error().message);
  return path.string();
}

}  // namespace spm::baker
